// The light on a surface, as of Shading (shading.h).
uniform vec4 material;  // ambient, diffuse, specular, shininess
uniform vec3 key;       // towards the key light, of unit length
vec2 light_on(vec3 normal, vec3 to_eye) {
  float head = max(dot(normal, to_eye), 0.0), side = max(dot(normal, key), 0.0);
  float halfway = max(dot(normal, normalize(key + to_eye)), 0.0);
  float gloss = pow(head, material.w) + pow(halfway, material.w);
  return vec2(material.x + material.y * 0.5 * (head + side), material.z * 0.5 * gloss);
}
