// The light on a surface, as of Shading (shading.h).
uniform vec4 material;  // ambient, diffuse, specular, shininess
uniform vec3 key;       // towards the key light, of unit length
uniform float head;     // the part of the light at the eye
vec2 light_on(vec3 normal, vec3 to_eye) {
  float front = max(dot(normal, to_eye), 0.0), side = max(dot(normal, key), 0.0);
  float halfway = max(dot(normal, normalize(key + to_eye)), 0.0);
  float gloss = pow(front, material.w) + pow(halfway, material.w);
  return vec2(material.x + material.y * (head * front + (1.0 - head) * side), material.z * 0.5 * gloss);
}
