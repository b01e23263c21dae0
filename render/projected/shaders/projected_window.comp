#version 450
// SPDX-License-Identifier: Apache-2.0
// The k-buffer of each pixel, applied to its list of faces, which is in the order in which they were drawn: at most kbuffer of
// them wait; of those and the next one, the nearest is released. So a face moves past waiting ones only.
layout(local_size_x = 64) in;
layout(location = 11) uniform uint kbuffer;

void main() {
    uint id = thread_number();
    if (id >= list_count()) return;
    uint first = offsets[id], end = offsets[id + 1u];
    State s = State(first, first, 0, 0u, vec2(0.0));
    if (resumed) {
        s = states[id];
        if (s.next >= end) return;
    }
    uint steps = 0u;
    for (; s.next < end && steps < list_steps; ++steps) {
        uint last = s.next - first > kbuffer ? s.next - kbuffer : first;
        if (s.at > last && crossings[s.at - 1u].x > crossings[s.at].x) {
            exchange(s.at - 1u, s.at);
            --s.at;
        } else {
            s.cover -= change_at(s.at);  // at the end of the ray there are no tetrahedra
            s.at = ++s.next;
        }
    }
    states[id] = s;
    if (s.next < end) atomicAdd(unfinished, 1u);
}
