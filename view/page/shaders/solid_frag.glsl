precision highp float;
in vec3 place;
in vec3 facing;
in float field, beyond;
uniform bool perspective;
out vec4 seen;  // value, the two parts of the light, whether there is a surface

void main() {
  if (beyond > 0.0 || place.z <= 0.0) discard;
  seen = vec4(field, light_on(normalize(facing), perspective ? -normalize(place) : vec3(0.0, 0.0, -1.0)), 1.0);
}
