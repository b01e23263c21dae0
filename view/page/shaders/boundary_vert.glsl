#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;
uniform vec3 right, up, forward, eye;
uniform vec2 half_size, near_far;
uniform bool perspective;
uniform vec4 clip;  // what is on the normal's side goes
out vec3 place;   // in eye space
out vec3 facing;  // the normal in eye space
out float field, beyond, start;  // start: the height of the ray's origin above the clip plane

void main() {
  vec3 seen = position - eye;
  place = vec3(dot(right, seen), dot(up, seen), dot(forward, seen));
  facing = vec3(dot(right, normal), dot(up, normal), dot(forward, normal));
  field = value;
  beyond = dot(clip.xyz, position) - clip.w;
  start = dot(clip.xyz, perspective ? eye : eye + place.x * right + place.y * up) - clip.w;
  // Depths of the clip space are only for the depth test of solid bodies: 1/z is linear in the picture, as they have to be.
  float w = perspective ? place.z : 1.0;
  gl_Position = vec4(place.xy / half_size, perspective ? w - 2.0 * near_far.x
                                                       : 1.998 * (place.z - near_far.x) / (near_far.y - near_far.x) - 0.999, w);
}
