#version 450
// SPDX-License-Identifier: Apache-2.0
// Composites the faces of each pixel as its k-buffer has released them. The value is linear between a face and the one released
// before.
layout(local_size_x = 64) in;
layout(std430, binding = 3) buffer Pictures { vec4 picture[]; };
layout(location = 11) uniform float eye_value;

const float kTouch = 1e-5;  // for two faces that are closer the order is rounding

// Where parts of the volume touch without sharing a face, rounding decides which of the two faces comes first. The ray has to
// leave one part before it enters the other, as their values may differ.
void leave_before_entering(uint i, uint end) {
    if (i + 1u >= end || change_at(i) <= 0 || change_at(i + 1u) >= 0) return;
    if (crossings[i + 1u].x - crossings[i].x <= kTouch) exchange(i, i + 1u);
}

void main() {
    uint id = thread_number();
    if (id >= list_count()) return;
    uint first = offsets[id], end = offsets[id + 1u];
    State s = states[id];
    float eye = -middle_depth;
    vec4 sum = vec4(0.0);
    if (resumed) {
        sum = picture[id];
        if (s.next >= end) return;
    } else {
        s.next = first;
        s.before = perspective ? vec2(eye, eye_value) : vec2(-1e30, 0.0);
    }
    vec2 slope = slope_of(id);
    float ray_length = perspective ? sqrt(1.0 + dot(slope, slope)) : 1.0;
    for (; s.next < end && steps < list_steps; ++s.next) {
        steps += kSegmentSteps;
        if (s.cover > 0) leave_before_entering(s.next, end);
        vec2 here = crossings[s.next];
        float from = max(s.before.x, eye);
        if (s.cover > 0 && from < here.x && 1.0 - sum.a > kRayCutoff) {
            float value = mix(s.before.y, here.y, (from - s.before.x) / (here.x - s.before.x));
            sum += (1.0 - sum.a) * visible_light(slope, vec2(from, value), here, ray_length);
        }
        if (here.x < s.before.x - kTouch) ++s.late;  // of a late face only the change of cover is used
        else if (s.cover == 0 || here.x > s.before.x) s.before = here;
        s.cover += change_at(s.next);
    }
    picture[id] = sum;
    states[id] = s;
    if (s.next < end) {
        atomicAdd(unfinished, 1u);
    } else if (s.late > 0u) {
        atomicAdd(wrong_pixels, 1u);
        atomicAdd(late_faces, s.late);
    }
}
