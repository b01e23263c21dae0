#version 450
// SPDX-License-Identifier: Apache-2.0
// Merges pairs of sorted runs into the other buffers. Each thread writes a block; bisection finds where it begins in both runs.
layout(local_size_x = 64) in;
layout(location = 11) uniform uint run;  // a multiple of kRun

void main() {
    if (thread_number() >= block_count) return;
    uvec2 block = blocks[thread_number()];
    uint begin = offsets[block.x], end = offsets[block.x + 1u], at = block.y * kRun, pair = at / (2u * run) * 2u * run;
    uint left = begin + pair, right = min(left + run, end), right_end = min(right + run, end);
    uint before_here = at - pair;  // entries of the pair
    uint low = before_here - min(before_here, right_end - right), high = min(before_here, right - left);
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (before(entry_at(left + middle), entry_at(right + before_here - 1u - middle))) low = middle + 1u;
        else high = middle;
    }
    uint l = left + low, r = right + before_here - low;
    for (uint to = begin + at; to < min(begin + at + kRun, right_end); ++to) {
        bool from_left = r >= right_end || (l < right && before(entry_at(l), entry_at(r)));
        put_other(to, entry_at(from_left ? l : r));
        if (from_left) ++l;
        else ++r;
    }
}
