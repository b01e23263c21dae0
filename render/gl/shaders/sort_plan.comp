#version 450
// SPDX-License-Identifier: Apache-2.0
// The number of groups of each pass of a sort, and the number of digit counts that they write.
layout(local_size_x = 1) in;
layout(std430, binding = 0) writeonly buffer Plan { uvec4 plan[]; };
layout(location = 2) uniform uint bins;

void main() {
    uint items = item_count();
    plan[0] = dispatch_of(items);
    plan[1] = uvec4(bins * blocks_of(items));
}
