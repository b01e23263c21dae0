#version 300 es
// What a kernel adds to the sums: its weight, and its weight times its value.
precision highp float;
in vec3 y;
flat in vec3 change;
flat in vec2 value;  // value, moment
out vec4 sums;

void main() {
  float e = dot(y, y), left = max(1.0 - e, 0.0), w = left * left * left;
  sums = vec4(w, w * (value.x + dot(change, y) + value.y * e), 0.0, 0.0);
}
