// The tables of the transfer function (page_transfer.js). Values are in parts of the field's range; x is in cells.
uniform highp sampler2D prefixes, table_means, bends, table_colors;
uniform vec2 to_cells;
const float kCells = 4096.0;

float cells_of(float value) { return clamp(value * to_cells.x + to_cells.y, -1e6, 1e6); }
ivec2 row_of(float x) {
  int row = int(clamp(floor(x), -1.0, kCells)) + 1;
  return ivec2(row & 63, row >> 6);
}
float part_of(float x) { return x - clamp(floor(x), -1.0, kCells); }
vec3 color_at(float x) {
  float inside = clamp(x, 0.0, kCells), part = fract(inside);
  vec3 here = texelFetch(table_colors, row_of(inside), 0).rgb, next = texelFetch(table_colors, row_of(inside + 1.0), 0).rgb;
  return mix(here, next, part);
}
vec4 light_at(float x) {
  ivec2 row = row_of(x);
  return texelFetch(table_means, row, 0) + (2.0 * part_of(x) - 1.0) * texelFetch(bends, row, 0);
}
vec4 within(float x) {
  ivec2 row = row_of(x);
  float s = part_of(x);
  return s * (texelFetch(table_means, row, 0) + (s - 1.0) * texelFetch(bends, row, 0));
}
// The mean extinction and emission between two values.
vec4 means(float x0, float x1) {
  float change = x1 - x0;
  if (abs(change) < 0.5) return max(light_at(0.5 * (x0 + x1)), 0.0);
  vec4 whole = texelFetch(prefixes, row_of(x1), 0) - texelFetch(prefixes, row_of(x0), 0);
  return max((whole + within(x1) - within(x0)) / change, 0.0);
}
