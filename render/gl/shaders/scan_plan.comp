#version 450
// SPDX-License-Identifier: Apache-2.0
// The number of groups of each level of a scan. The sums of a level's blocks are the items of the next level.
layout(local_size_x = 1) in;
layout(std430, binding = 0) writeonly buffer Plan { uvec4 plan[]; };
layout(location = 2) uniform uint levels;

void main() {
    uint items = item_count() + 1u;  // the total comes last
    for (uint level = 0u; level < levels; ++level) {
        plan[level] = dispatch_of(items);
        items = blocks_of(items);
    }
}
