#version 450
// SPDX-License-Identifier: Apache-2.0
// Counts how often each digit occurs in each block. The counts of a digit lie side by side for all blocks, so that a scan gives
// the place of the first item of each block.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Keys { uint keys[]; };
layout(std430, binding = 1) writeonly buffer Counts { uint counts[]; };
layout(std430, binding = 2) readonly buffer Plan { uvec4 plan[]; };

shared uint block_counts[256];

void main() {
    uint items = plan[0].w, blocks = blocks_of(items), group = group_number(), thread = gl_LocalInvocationIndex;
    block_counts[thread] = 0u;
    barrier();
    for (uint k = 0u; k < kItems; ++k) {
        uint i = group * kBlock + k * kThreads + thread;
        if (i < items) atomicAdd(block_counts[digit(keys[i])], 1u);  // integers: the order of the additions does not matter
    }
    barrier();
    if (thread < (1u << bits) && group < blocks) counts[thread * blocks + group] = block_counts[thread];
}
