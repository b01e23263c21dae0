// SPDX-License-Identifier: Apache-2.0
// The entries of lists while they are sorted. No two of a list are equal.
#if FACES
struct Entry {
    vec2 crossing;
    uint mark;
};
layout(std430, binding = 5) buffer Crossings { vec2 crossings[]; };
layout(std430, binding = 6) buffer Marks { uint marks[]; };
layout(std430, binding = 7) buffer OtherCrossings { vec2 other_crossings[]; };
layout(std430, binding = 8) buffer OtherMarks { uint other_marks[]; };

Entry entry_at(uint i) { return Entry(crossings[i], marks[i]); }
void put(uint i, Entry e) {
    crossings[i] = e.crossing;
    marks[i] = e.mark;
}
void put_other(uint i, Entry e) {
    other_crossings[i] = e.crossing;
    other_marks[i] = e.mark;
}

// In the order in which they were drawn: the device draws in order but may store out of order.
bool before(Entry l, Entry r) { return l.mark < r.mark; }
#else
struct Entry {
    vec4 segment;
    uint rank;
};
layout(std430, binding = 5) buffer Segments { vec4 segments[]; };
layout(std430, binding = 6) buffer Ranks { uint ranks[]; };
layout(std430, binding = 7) buffer OtherSegments { vec4 other_segments[]; };
layout(std430, binding = 8) buffer OtherRanks { uint other_ranks[]; };

Entry entry_at(uint i) { return Entry(segments[i], ranks[i]); }
void put(uint i, Entry e) {
    segments[i] = e.segment;
    ranks[i] = e.rank;
}
void put_other(uint i, Entry e) {
    other_segments[i] = e.segment;
    other_ranks[i] = e.rank;
}

// From front to back. Neighbours compute bitwise the same depth on the face between them.
bool before(Entry l, Entry r) { return l.segment.x < r.segment.x || (l.segment.x == r.segment.x && l.rank > r.rank); }
#endif

layout(std430, binding = 12) readonly buffer Blocks { uvec2 blocks[]; };  // of kRun entries: the list, and the block's number
layout(location = 10) uniform uint block_count;
const uint kRun = 64u;
