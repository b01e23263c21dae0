#version 450
// SPDX-License-Identifier: Apache-2.0
// The pixels that the triangles cover. FILL 0 counts the hits of each pixel, FILL 1 writes them in any order. The threads of a
// group share a block of strips.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer StripOffsets { uint strip_offsets[]; };
layout(std430, binding = 1) readonly buffer EyePoints { EyePoint eye_points[]; };
layout(std430, binding = 2) readonly buffer Triangles { uint corners[]; };
layout(std430, binding = 3) readonly buffer Boxes { ivec4 boxes[]; };
layout(std430, binding = 4) buffer Counts { uint counts[]; };  // of each pixel, and a mark; FILL: the hits written so far
layout(std430, binding = 5) readonly buffer HitOffsets { uint hit_offsets[]; };
layout(std430, binding = 6) writeonly buffer Hits { vec2 hits[]; };  // depth relative to the middle; +1 where the ray enters

struct Plane {
    dvec3 normal;
    double offset, z_min, z_max;
};

Plane plane_of(EyePoint a, EyePoint b, EyePoint c) {
    precise dvec3 u = dvec3(b.x - a.x, b.y - a.y, b.z - a.z), v = dvec3(c.x - a.x, c.y - a.y, c.z - a.z);
    precise dvec3 n = dvec3(u.y * v.z - v.y * u.z, u.z * v.x - v.z * u.x, u.x * v.y - v.x * u.y);
    precise double offset = n.x * a.x + n.y * a.y + n.z * a.z;
    return Plane(n, offset, min(min(a.z, b.z), c.z), max(max(a.z, b.z), c.z));
}

double depth_at(Plane p, int x, int y) {
    precise double sx = (double(x) + 0.5lf - 0.5lf * double(size.x)) * scale.x;
    precise double sy = (0.5lf * double(size.y) - (double(y) + 0.5lf)) * scale.x;
    precise double above = perspective ? p.offset : p.offset - p.normal.x * sx - p.normal.y * sy;
    precise double below = perspective ? p.normal.x * sx + p.normal.y * sy + p.normal.z : p.normal.z;
    if (below == 0.0lf) return p.z_min;  // seen edge-on
    precise double z = above / below;
    return clamp(z, p.z_min, p.z_max);
}

// Whether the triangle with the edge ab owns the points on it; its neighbour has the edge as ba.
bool owns_edge(ivec2 a, ivec2 b) { return a.y != b.y ? b.y > a.y : b.x < a.x; }

bool inside_edge(ivec2 a, ivec2 b, ivec2 p) {
    Product left = product(b.x - a.x, p.y - a.y), right_side = product(b.y - a.y, p.x - a.x);
    return less_product(right_side, left) || (same_product(left, right_side) && owns_edge(a, b));
}

void cover(uint id, uint strip) {
    EyePoint a = eye_points[corners[3u * id]], b = eye_points[corners[3u * id + 1u]], c = eye_points[corners[3u * id + 2u]];
    ivec4 box = boxes[id];
    int y = box.y + int(strip) / box.z, x0 = box.x + int(strip) % box.z * kStrip_px, x1 = min(x0 + kStrip_px - 1, box.w);
    // Triangles are counter-clockwise as seen from outside. As rows run downwards, the area is negative where they face the
    // eye.
    bool enters = less_product(product(b.px.x - a.px.x, c.px.y - a.px.y), product(b.px.y - a.px.y, c.px.x - a.px.x));
    ivec2 second = enters ? c.px : b.px, third = enters ? b.px : c.px;
#if FILL
    Plane plane = plane_of(a, b, c);
#endif
    for (int x = x0; x <= x1; ++x) {
        ivec2 p = ivec2(x, y) * kSnap + kSnap / 2;
        if (!inside_edge(a.px, second, p) || !inside_edge(second, third, p) || !inside_edge(third, a.px, p)) continue;
        uint pixel = uint(y) * uint(size.x) + uint(x), before = atomicAdd(counts[pixel], 1u);
#if FILL
        uint to = hit_offsets[pixel] + before;
        if (to < most_hits) hits[to] = vec2(float(depth_at(plane, x, y) - scale.y), enters ? 1.0 : -1.0);
#else
        if (before == kMostHits) counts[uint(size.x) * uint(size.y) + 1u] = 1u;  // too many: the CPU sorts them
#endif
    }
}

void main() {
    uint total = strip_offsets[triangles];
    for (uint k = 0u; k < kItems; ++k) {
        uint item = group_number() * kBlock + k * kThreads + gl_LocalInvocationIndex;
        if (item >= total) return;
        uint low = 0u, high = triangles - 1u;  // finds the last triangle that begins at or before the strip
        while (low < high) {
            uint middle = (low + high + 1u) / 2u;
            if (strip_offsets[middle] <= item) low = middle;
            else high = middle - 1u;
        }
        cover(low, item - strip_offsets[low]);
    }
}
