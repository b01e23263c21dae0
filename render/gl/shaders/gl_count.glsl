// SPDX-License-Identifier: Apache-2.0
// The number of items, which the host knows or a buffer holds.
layout(std430, binding = 7) readonly buffer CountSource { uint count_source[]; };
layout(location = 0) uniform uint most_items;
layout(location = 1) uniform int count_word;  // -1: the host knows it

uint item_count() { return count_word < 0 ? most_items : min(count_source[count_word], most_items); }
