#version 450
// SPDX-License-Identifier: Apache-2.0
// The pixels that each triangle may cover, and the number of strips of rows that they need.
layout(local_size_x = 256) in;
layout(std430, binding = 1) readonly buffer EyePoints { EyePoint eye_points[]; };
layout(std430, binding = 2) readonly buffer Triangles { uint corners[]; };
layout(std430, binding = 3) writeonly buffer Boxes { ivec4 boxes[]; };  // first x, y; strips in a row; last x
layout(std430, binding = 4) writeonly buffer Strips { uint strips[]; };
layout(std430, binding = 5) buffer Total { uint total[2]; };  // of strips, 64 bits

shared uint group_strips;

// The first pixel whose centre is at a snapped place or beyond, and the last whose centre is at it or before.
int first_pixel(int snapped) { return (snapped + kSnap / 2 - 1) >> 12; }
int last_pixel(int snapped) { return (snapped - kSnap / 2) >> 12; }

// The number of strips of a triangle, for which it sets the box.
uint find_strips(uint id) {
    ivec2 a = eye_points[corners[3u * id]].px, b = eye_points[corners[3u * id + 1u]].px, c = eye_points[corners[3u * id + 2u]].px;
    if (same_product(product(b.x - a.x, c.y - a.y), product(b.y - a.y, c.x - a.x))) return 0u;
    ivec2 low = min(min(a, b), c), high = max(max(a, b), c);
    int x0 = max(first_pixel(low.x), 0), x1 = min(last_pixel(high.x), size.x - 1);
    int y0 = max(first_pixel(low.y), 0), y1 = min(last_pixel(high.y), size.y - 1);
    if (x1 < x0 || y1 < y0) return 0u;
    int in_row = (x1 - x0) / kStrip_px + 1;
    boxes[id] = ivec4(x0, y0, in_row, x1);
    return uint(in_row) * uint(y1 - y0 + 1);
}

void main() {
    uint id = group_number() * kThreads + gl_LocalInvocationIndex;
    if (gl_LocalInvocationIndex == 0u) group_strips = 0u;
    barrier();
    if (id < triangles) {
        uint count = find_strips(id);
        strips[id] = count;
        atomicAdd(group_strips, min(count, kMostStrips / 2u));  // the sum of a group fits
    }
    barrier();
    if (gl_LocalInvocationIndex != 0u || group_strips == 0u) return;
    uint before = atomicAdd(total[0], group_strips);
    if (before + group_strips < before) atomicAdd(total[1], 1u);
}
