// SPDX-License-Identifier: Apache-2.0
shared uint group_sums[2][kThreads];

// The sum of the values of this thread and of those before it in the group. Every thread of the group must call it.
uint group_scan(uint value) {
    uint thread = gl_LocalInvocationIndex;
    group_sums[0][thread] = value;
    barrier();
    uint from = 0u;
    for (uint reach = 1u; reach < kThreads; reach *= 4u) {  // in steps of four: half as many barriers as in steps of two
        for (uint i = 1u; i < 4u; ++i) value += thread >= i * reach ? group_sums[from][thread - i * reach] : 0u;
        from = 1u - from;
        group_sums[from][thread] = value;
        barrier();
    }
    return value;
}

// The sum over all threads in the last group_scan.
uint group_total() { return group_sums[0][kThreads - 1u]; }
