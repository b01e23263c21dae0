#version 450
// SPDX-License-Identifier: Apache-2.0
// The number of groups that rasterize the strips.
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer StripOffsets { uint strip_offsets[]; };
layout(std430, binding = 1) writeonly buffer Plan { uvec4 plan; };

void main() { plan = dispatch_of(strip_offsets[triangles]); }
