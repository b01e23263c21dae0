#version 450
// SPDX-License-Identifier: Apache-2.0
// The number of groups that rasterize the strips: none if there are too many strips, which the CPU does then.
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer StripOffsets { uint strip_offsets[]; };
layout(std430, binding = 1) writeonly buffer Plan { uvec4 plan; };
layout(std430, binding = 2) readonly buffer Total { uint total[2]; };
layout(std430, binding = 3) writeonly buffer Counts { uint counts[]; };  // of each pixel, and a mark

void main() {
    bool too_many = total[1] != 0u || total[0] > kMostStrips;
    plan = dispatch_of(too_many ? 0u : strip_offsets[triangles]);
    if (too_many) counts[uint(size.x) * uint(size.y) + 1u] = 1u;
}
