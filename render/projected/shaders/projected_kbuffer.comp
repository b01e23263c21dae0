#version 450
// SPDX-License-Identifier: Apache-2.0
// The k-buffer of each pixel, applied to its list of faces. Faces come in the order in which they were drawn. At most kbuffer
// of them wait; of those and the next one, the nearest is released. The value is linear between it and the one released before.
layout(local_size_x = 64) in;
layout(std430, binding = 3) writeonly buffer Pictures { vec4 picture[]; };
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 5) buffer Crossings { vec2 crossings[]; };  // depth, value
layout(std430, binding = 6) buffer Marks { uint marks[]; };  // 8 · rank + 2 + tetrahedra behind the face − before it
layout(std430, binding = 11) buffer Misses { uint late_pixels, late_faces; };
uniform ivec4 rectangle;
uniform uint kbuffer;
uniform float eye_value;

const float kTouch = 1e-5;  // for two faces that are closer the order is rounding

// The device draws in order but may store out of order. The list is nearly sorted, so insertion sort is fast.
void sort_by_rank(uint first, uint end) {
    for (uint i = first + 1u; i < end; ++i) {
        vec2 crossing = crossings[i];
        uint mark = marks[i], k = i;
        for (; k > first && marks[k - 1u] > mark; --k) {
            crossings[k] = crossings[k - 1u];
            marks[k] = marks[k - 1u];
        }
        crossings[k] = crossing;
        marks[k] = mark;
    }
}

// An entry moves past waiting entries only, of which there are at most kbuffer.
void sort_in_window(uint first, uint end) {
    for (uint i = first + 1u; i < end; ++i) {
        vec2 crossing = crossings[i];
        uint mark = marks[i], k = i, last = i - first > kbuffer ? i - kbuffer : first;
        for (; k > last && crossings[k - 1u].x > crossing.x; --k) {
            crossings[k] = crossings[k - 1u];
            marks[k] = marks[k - 1u];
        }
        crossings[k] = crossing;
        marks[k] = mark;
    }
}

int change_at(uint i) { return int(marks[i] & 7u) - 2; }

// Where parts of the volume touch without sharing a face, rounding decides which of the two faces comes first. The ray has to
// leave one part before it enters the other, as their values may differ.
void leave_before_entering(uint i, uint end) {
    if (i + 1u >= end || change_at(i) <= 0 || change_at(i + 1u) >= 0) return;
    vec2 here = crossings[i], next = crossings[i + 1u];
    if (next.x - here.x > kTouch) return;
    uint mark = marks[i];
    crossings[i] = next;
    marks[i] = marks[i + 1u];
    crossings[i + 1u] = here;
    marks[i + 1u] = mark;
}

void main() {
    uint id = gl_WorkGroupID.y * gl_NumWorkGroups.x * 64u + gl_GlobalInvocationID.x;
    uint width = uint(rectangle.z - rectangle.x);
    if (id >= width * uint(rectangle.w - rectangle.y)) return;
    uint first = offsets[id], end = offsets[id + 1u];
    sort_by_rank(first, end);
    sort_in_window(first, end);

    vec2 slope = (vec2(rectangle.xy) + vec2(id % width, id / width) + 0.5 - middle_px) * vec2(pixel, -pixel);
    float ray_length = perspective ? sqrt(1.0 + dot(slope, slope)) : 1.0;
    float eye = -middle_depth;
    vec2 before = perspective ? vec2(eye, eye_value) : vec2(-1e30, 0.0);
    int cover = 0;  // tetrahedra at this place; at the end of the ray there are none
    for (uint i = first; i < end; ++i) cover -= change_at(i);
    vec4 sum = vec4(0.0);
    uint late = 0u;
    for (uint i = first; i < end; ++i) {
        if (cover > 0) leave_before_entering(i, end);
        vec2 here = crossings[i];
        float from = max(before.x, eye);
        if (cover > 0 && from < here.x && 1.0 - sum.a > kRayCutoff) {
            float value = mix(before.y, here.y, (from - before.x) / (here.x - before.x));
            sum += (1.0 - sum.a) * visible_light(slope, vec2(from, value), here, ray_length);
        }
        if (here.x < before.x - kTouch) ++late;  // of a late face only the change of cover is used
        else if (cover == 0 || here.x > before.x) before = here;
        cover += change_at(i);
    }
    picture[id] = sum;
    if (late > 0u) {
        atomicAdd(late_pixels, 1u);
        atomicAdd(late_faces, late);
    }
}
