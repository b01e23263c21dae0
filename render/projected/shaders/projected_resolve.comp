#version 450
// SPDX-License-Identifier: Apache-2.0
// Sorts the list of each pixel from front to back, integrates and composites it. The lists are nearly sorted, so insertion sort
// is fast.
layout(local_size_x = 64) in;
layout(std430, binding = 3) writeonly buffer Pictures { vec4 picture[]; };
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 5) buffer Segments { vec4 segments[]; };  // depths of both ends, values there
layout(std430, binding = 6) buffer Ranks { uint ranks[]; };
layout(std430, binding = 11) buffer Violations { uint violations; };
uniform ivec4 rectangle;

// For thinner segments the order is rounding.
const float kTouch = 1e-5;

// Neighbours compute bitwise the same depth on the face between them.
void sort_list(uint first, uint end) {
    for (uint i = first + 1u; i < end; ++i) {
        vec4 segment = segments[i];
        uint rank = ranks[i], k = i;
        for (; k > first; --k) {
            vec4 other = segments[k - 1u];
            if (other.x < segment.x || (other.x == segment.x && ranks[k - 1u] > rank)) break;
            segments[k] = other;
            ranks[k] = ranks[k - 1u];
        }
        segments[k] = segment;
        ranks[k] = rank;
    }
}

// Ranks count from back to front: what is nearer has the higher rank.
bool in_order(uint first, uint end) {
    bool known = false;
    uint last = 0u;
    for (uint i = first; i < end; ++i) {
        if (!(segments[i].y - segments[i].x > kTouch)) continue;
        if (known && ranks[i] > last) return false;
        last = ranks[i];
        known = true;
    }
    return true;
}

void main() {
    uint id = gl_WorkGroupID.y * gl_NumWorkGroups.x * 64u + gl_GlobalInvocationID.x;
    uint width = uint(rectangle.z - rectangle.x);
    if (id >= width * uint(rectangle.w - rectangle.y)) return;
    uint first = offsets[id], end = offsets[id + 1u];
    sort_list(first, end);
    if (!in_order(first, end)) atomicAdd(violations, 1u);

    vec2 slope = (vec2(rectangle.xy) + vec2(id % width, id / width) + 0.5 - middle_px) * vec2(pixel, -pixel);
    float ray_length = perspective ? sqrt(1.0 + dot(slope, slope)) : 1.0;
    vec4 sum = vec4(0.0);
    float done = -middle_depth;  // every depth counts once, even where cells fold over
    for (uint i = first; i < end && 1.0 - sum.a > kRayCutoff; ++i) {
        vec4 segment = segments[i];
        float from = max(done, segment.x);
        if (!(from < segment.y)) continue;
        float value = mix(segment.z, segment.w, (from - segment.x) / (segment.y - segment.x));
        sum += (1.0 - sum.a) * visible_light(slope, vec2(from, value), segment.yw, ray_length);
        done = segment.y;
    }
    picture[id] = sum;
}
