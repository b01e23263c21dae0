#version 450
// SPDX-License-Identifier: Apache-2.0
// Sorts the hits of each pixel and replaces them by intervals.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer HitOffsets { uint hit_offsets[]; };
layout(std430, binding = 1) buffer Hits { vec2 hits[]; };
layout(std430, binding = 2) writeonly buffer IntervalRanges { uvec2 interval_ranges[]; };  // first, end

// Where two shells touch, the entry into one comes before the exit from the other: no gap opens.
bool before(vec2 l, vec2 r) { return l.x != r.x ? l.x < r.x : l.y > r.y; }

// Of at most kMostHits.
void sort_hits(uint first, uint end) {
    for (uint i = first + 1u; i < end; ++i) {
        vec2 hit = hits[i];
        uint to = i;
        for (; to > first && before(hit, hits[to - 1u]); --to) hits[to] = hits[to - 1u];
        hits[to] = hit;
    }
}

// As is_long() and resolve() of boundary_intervals.cpp.
bool is_long(float enter, float leave) {
    const float kRoundings = 16.0 * 1.1920929e-7;
    return leave - enter > kRoundings * max(abs(enter), abs(leave));
}

uint resolve(uint first, uint end) {
    int inside = 0;  // how often the surface goes round the eye, and then round the place behind each hit
    for (uint i = first; i < end; ++i) inside -= int(hits[i].y);
    float enter = float(scale.z);
    uint to = first;
    bool turned = false;  // whether the interval begins where the ray leaves the surface
    for (uint i = first; i < end; ++i) {
        vec2 hit = hits[i];
        if (inside == 0) {
            enter = hit.x;
            turned = hit.y < 0.0;
        }
        inside += int(hit.y);
        if (inside == 0 && hit.x > enter && (!turned || is_long(enter, hit.x))) hits[to++] = vec2(enter, hit.x);
    }
    return to;
}

void main() {
    uint pixel = group_number() * kThreads + gl_LocalInvocationIndex;
    if (pixel >= uint(size.x) * uint(size.y)) return;
    uint first = min(hit_offsets[pixel], most_hits), end = min(hit_offsets[pixel + 1u], most_hits);
    if (end - first > kMostHits) end = first;
    sort_hits(first, end);
    interval_ranges[pixel] = uvec2(first, resolve(first, end));
}
