#version 450
// SPDX-License-Identifier: Apache-2.0
// Finds where the keys of each bin begin, by bisection: a bin without keys costs no more than a full one.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Keys { uint keys[]; };
layout(std430, binding = 1) writeonly buffer Offsets { uint offsets[]; };
layout(location = 2) uniform uint bins;

void main() {
    uint bin = group_number() * kThreads + gl_LocalInvocationIndex;
    if (bin > bins) return;
    uint low = 0u, high = item_count();
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (keys[middle] < bin) low = middle + 1u;
        else high = middle;
    }
    offsets[bin] = low;
}
