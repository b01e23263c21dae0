#version 450
// SPDX-License-Identifier: Apache-2.0
// Adds up each block.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Values { uint values[]; };
layout(std430, binding = 1) writeonly buffer Sums { uint sums[]; };
layout(std430, binding = 2) readonly buffer Plan { uvec4 plan[]; };
layout(location = 2) uniform uint level;

void main() {
    uint items = plan[level].w - (level == 0u ? 1u : 0u);  // the last place is for the total and has no value yet
    uint group = group_number(), first = group * kBlock + gl_LocalInvocationIndex;
    uint sum = 0u;
    for (uint k = 0u; k < kItems; ++k) {
        uint i = first + k * kThreads;
        if (i < items) sum += values[i];
    }
    sum = group_scan(sum);
    if (gl_LocalInvocationIndex == kThreads - 1u && group < blocks_of(plan[level].w)) sums[group] = sum;
}
