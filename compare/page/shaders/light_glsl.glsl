// The light of a head light and a key light on a surface (Blinn and Phong), as of SplatOptions::shading.
vec2 light_on(vec3 normal, vec3 to_eye) {
  vec3 key = normalize(vec3(-0.5, 0.7, -0.5));
  float head = max(dot(normal, to_eye), 0.0), side = max(dot(normal, key), 0.0);
  float halfway = max(dot(normal, normalize(key + to_eye)), 0.0);
  return vec2(0.3 + 0.7 * 0.5 * (head + side), 0.25 * 0.5 * (pow(head, 32.0) + pow(halfway, 32.0)));
}
