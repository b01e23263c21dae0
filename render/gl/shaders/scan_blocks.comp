#version 450
// SPDX-License-Identifier: Apache-2.0
// Replaces each value by the sum of those before it: in its block, and in earlier blocks, whose sums have been scanned already.
layout(local_size_x = 256) in;
layout(std430, binding = 0) buffer Values { uint values[]; };
layout(std430, binding = 1) readonly buffer Sums { uint sums[]; };
layout(std430, binding = 2) readonly buffer Plan { uvec4 plan[]; };
layout(location = 2) uniform uint level;
layout(location = 3) uniform bool top;  // there is one block, and nothing before it

shared uint block[kPaddedBlock];

void main() {
    uint items = plan[level].w, valid = items - (level == 0u ? 1u : 0u);
    uint group = group_number(), thread = gl_LocalInvocationIndex, first = group * kBlock;
    for (uint i = thread; i < kBlock; i += kThreads) block[padded(i)] = first + i < valid ? values[first + i] : 0u;
    barrier();
    uint own[kItems], sum = 0u;
    for (uint k = 0u; k < kItems; ++k) {
        own[k] = block[padded(thread * kItems + k)];
        sum += own[k];
    }
    uint before = group_scan(sum) - sum;
    if (!top && first < items) before += sums[group];
    for (uint k = 0u; k < kItems; ++k) {
        block[padded(thread * kItems + k)] = before;
        before += own[k];
    }
    barrier();
    for (uint i = thread; i < kBlock; i += kThreads) {
        if (first + i < items) values[first + i] = block[padded(i)];
    }
}
