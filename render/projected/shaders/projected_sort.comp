#version 450
// SPDX-License-Identifier: Apache-2.0
// Sorts each block of a list, in at most kRun² / 2 steps. Blocks come nearly sorted, so insertion is fast.
layout(local_size_x = 64) in;
layout(location = 11) uniform uint moved_blocks;  // the first ones, which are moved to the other buffers

void main() {
    if (thread_number() >= block_count) return;
    uvec2 block = blocks[thread_number()];
    uint first = offsets[block.x] + block.y * kRun, end = min(first + kRun, offsets[block.x + 1u]);
    for (uint i = first + 1u; i < end; ++i) {
        Entry moving = entry_at(i);
        uint k = i;
        for (; k > first; --k) {
            Entry other = entry_at(k - 1u);
            if (before(other, moving)) break;
            put(k, other);
        }
        if (k < i) put(k, moving);
    }
    if (thread_number() >= moved_blocks) return;
    for (uint i = first; i < end; ++i) put_other(i, entry_at(i));
}
