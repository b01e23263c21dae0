#version 450
// SPDX-License-Identifier: Apache-2.0
// Integrates and composites the sorted list of each pixel.
layout(local_size_x = 64) in;
layout(std430, binding = 3) buffer Pictures { vec4 picture[]; };
layout(std430, binding = 5) readonly buffer Segments { vec4 segments[]; };  // depths of both ends, values there
layout(std430, binding = 6) readonly buffer Ranks { uint ranks[]; };
struct State {
    uint next;
    uint last_rank;  // of a segment that is not too thin
    bool known, wrong;
    float done;  // every depth counts once, even where cells fold over
};
layout(std430, binding = 12) buffer States { State states[]; };

// For thinner segments the order is rounding.
const float kTouch = 1e-5;

// Ranks count from back to front: what is nearer has the higher rank.
void check_order(inout State s, vec4 segment, uint rank) {
    if (!(segment.y - segment.x > kTouch)) return;
    s.wrong = s.wrong || (s.known && rank > s.last_rank);
    s.last_rank = rank;
    s.known = true;
}

void main() {
    uint id = thread_number();
    if (id >= list_count()) return;
    uint first = offsets[id], end = offsets[id + 1u];
    State s = State(first, 0u, false, false, -middle_depth);
    vec4 sum = vec4(0.0);
    if (resumed) {
        s = states[id];
        sum = picture[id];
        if (s.next >= end) return;
    }
    vec2 slope = slope_of(id);
    float ray_length = perspective ? sqrt(1.0 + dot(slope, slope)) : 1.0;
    for (; s.next < end && steps < list_steps; ++s.next) {
        steps += kSegmentSteps;
        vec4 segment = segments[s.next];
        check_order(s, segment, ranks[s.next]);
        float from = max(s.done, segment.x);
        if (!(from < segment.y) || 1.0 - sum.a <= kRayCutoff) continue;
        float value = mix(segment.z, segment.w, (from - segment.x) / (segment.y - segment.x));
        sum += (1.0 - sum.a) * visible_light(slope, vec2(from, value), segment.yw, ray_length);
        s.done = segment.y;
    }
    picture[id] = sum;
    states[id] = s;
    if (s.next < end) atomicAdd(unfinished, 1u);
    else if (s.wrong) atomicAdd(wrong_pixels, 1u);
}
