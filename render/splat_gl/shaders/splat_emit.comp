#version 450
// SPDX-License-Identifier: Apache-2.0
// Writes a key and a kernel for each bin that a kernel meets. Each thread writes an entry and finds its kernel by bisection.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Offsets { uint offsets[]; };  // of each kernel's entries; the last one is the total
layout(std430, binding = 1) readonly buffer Rects { uvec4 rects[]; };
layout(std430, binding = 2) writeonly buffer Keys { uint keys[]; };
layout(std430, binding = 3) writeonly buffer Ids { uint ids[]; };

void main() {
    uint entry = group_number() * kThreads + gl_LocalInvocationIndex;
    if (entry >= min(offsets[kernels], most_entries)) return;
    uint low = 0u, high = kernels - 1u;  // finds the last kernel that begins at or before the entry
    while (low < high) {
        uint middle = (low + high + 1u) / 2u;
        if (offsets[middle] <= entry) low = middle;
        else high = middle - 1u;
    }
    uvec3 first = rects[low].xyz & 0xffffu, count = max(rects[low].xyz >> 16, 1u);
    uint local = entry - offsets[low], in_row = local / count.z;
    uint tile = (first.y + in_row / count.x) * uint(tiles.x) + first.x + in_row % count.x;
    keys[entry] = tile * uint(end_batch - first_batch) + first.z + local % count.z - uint(first_batch);
    ids[entry] = low;
}
