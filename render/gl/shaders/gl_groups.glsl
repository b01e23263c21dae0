// SPDX-License-Identifier: Apache-2.0
// Work groups of 256 threads with 8 items each. Groups are numbered over two dimensions, in rows of at most 1024: one dimension
// can only have 65535, and with short rows the second dimension is used often, hence tested.
const uint kThreads = 256u;
const uint kItems = 8u;
const uint kMostInRow = 1024u;
const uint kBlock = kThreads * kItems;

uint blocks_of(uint items) { return (items + kBlock - 1u) / kBlock; }

uint group_number() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

// Arguments of an indirect dispatch with one group for each block; the last component is the number of items.
uvec4 dispatch_of(uint items) {
    uint blocks = blocks_of(items), y = (blocks + kMostInRow - 1u) / kMostInRow;
    return uvec4(y > 0u ? (blocks + y - 1u) / y : 0u, y, 1u, items);
}

// The padded place of a word in shared memory. The threads of a warp use different banks, both if their words are neighbours
// and if they are 8 apart.
uint padded(uint word) { return word + (word >> 5); }
const uint kPaddedBlock = kBlock + kBlock / 32u;
