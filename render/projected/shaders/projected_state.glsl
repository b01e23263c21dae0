// SPDX-License-Identifier: Apache-2.0
// The list of faces of a pixel, and what has been done with it.
layout(std430, binding = 5) buffer Crossings { vec2 crossings[]; };  // depth, value
layout(std430, binding = 6) buffer Marks { uint marks[]; };  // 8 · rank + 2 + tetrahedra behind the face − before it
struct State {
    uint next, at;  // at: where the face that was at `next` has been moved to
    int cover;      // tetrahedra at this place
    uint late;
    vec2 before;  // depth and value of the face released before
};
layout(std430, binding = 12) buffer States { State states[]; };

int change_at(uint i) { return int(marks[i] & 7u) - 2; }

void exchange(uint i, uint k) {
    vec2 crossing = crossings[i];
    uint mark = marks[i];
    crossings[i] = crossings[k];
    marks[i] = marks[k];
    crossings[k] = crossing;
    marks[k] = mark;
}
