#version 450
// SPDX-License-Identifier: Apache-2.0
// Classifies a sheet and composites the stretches of rays between it and the last one.
layout(local_size_x = 8, local_size_y = 8) in;
struct Last {
    float value, weight, depth;
    uint interval;  // of the pixel's, that the ray is in or reaches next
};
layout(binding = 0) uniform sampler2D sums;
layout(binding = 1) uniform sampler2D more_sums;
layout(std430, binding = 10) readonly buffer IntervalOffsets { uint interval_offsets[]; };
layout(std430, binding = 11) readonly buffer Intervals { vec2 intervals[]; };
layout(std430, binding = 12) buffer Beams { vec4 beams[]; };  // colour, opacity
layout(std430, binding = 13) buffer Lasts { Last lasts[]; };
layout(std430, binding = 14) buffer Looks { vec4 looks[]; };  // of the last sheet: second colour's value, light
layout(std430, binding = 15) buffer Done { uint done_pixels; };
layout(std430, binding = 6) readonly buffer Ends { vec4 ends[]; };  // of each interval: value, second value, light
layout(location = 5) uniform ivec4 rectangle;  // two corners; the second one is outside
layout(location = 6) uniform ivec2 size_px;
layout(location = 7) uniform vec2 middle_px;
layout(location = 8) uniform float pixel;
layout(location = 9) uniform float front_z;
layout(location = 10) uniform float back_z;
layout(location = 11) uniform float near;
layout(location = 12) uniform float middle_z;
layout(location = 13) uniform vec2 offsets;  // are added to the values of both channels where sums are not normalised
layout(location = 14) uniform bool first;

bool is_known(float weight) {
#if NORMALIZED
    return weight > kLeastWeight;
#else
    return true;
#endif
}

Seen seen_here(ivec2 at) {
    vec2 sum = texelFetch(sums, at, 0).xy;
    Seen here = Seen(0.0, sum.x, 0.0, vec2(1.0, 0.0), is_known(sum.x));
    float weight = NORMALIZED == 1 && here.known ? sum.x : 1.0;
    if (here.known) here.value = clamp(sum.y / weight + offsets.x, -kFarCells, kFarCells);
#if SHADED || COLORED
    vec4 more = texelFetch(more_sums, at, 0);
    if (here.known) here.color = clamp(more.w / weight + offsets.y, -kFarCells, kFarCells);
#if SHADED
    here.light = light_on(more.xyz * (1.0 / weight));
#endif
#endif
    return here;
}

vec2 interval(uint i) {
#if INTERVALS
    return intervals[i];
#else
    return vec2(near, uintBitsToFloat(0x7f800000u));
#endif
}

End end_of_interval(uint i) {
#if INTERVALS
    return End(ends[i].x, ends[i].y, ends[i].zw);
#else
    return End(3e38, 0.0, vec2(1.0, 0.0));
#endif
}

// The pixel's intervals: first, end.
uvec2 intervals_of(uint id) {
#if INTERVALS
    return uvec2(interval_offsets[id], interval_offsets[id + 1u]);
#else
    return uvec2(0u, 1u);
#endif
}

void main() {
    ivec2 at = rectangle.xy + ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, rectangle.zw))) return;
    uint id = uint(at.y * size_px.x + at.x);
    Last last = lasts[id];
    uvec2 range = intervals_of(id);
    uint end = range.y;
    last.interval += range.x;
    if (last.interval >= end) return;
    if (interval(last.interval).x >= back_z + 1.5 * (back_z - front_z)) {  // the next sheet does not need these values
        if (last.weight != 0.0) lasts[id].weight = 0.0;
        return;
    }
    ray = (vec2(at) + 0.5 - middle_px) * vec2(pixel, -pixel);
    Seen here = seen_here(at);
    if (!first) {
        Seen before = Seen(last.value, last.weight, 0.0, vec2(1.0, 0.0), is_known(last.weight));
#if SHADED || COLORED
        vec4 look = looks[id];
        before.color = look.x;
        before.light = look.yz;
#endif
        float ray_length = perspective ? sqrt(1.0 + dot(ray, ray)) : 1.0;
        vec4 light = beams[id];
        Beam beam = Beam(light.rgb, light.a, last.depth);
        for (; last.interval < end; ++last.interval) {
            vec2 inside = interval(last.interval);
            if (inside.x >= back_z) break;
            End enter = end_of_interval(2u * last.interval);
            if (inside.x == inside.y) {  // a slice
                see_slice(beam, enter, inside.x);
            } else {
                float skin = kSkin_px * pixel * (perspective ? middle_z + inside.x : 1.0);
                follow(beam, before, here, front_z, back_z, inside, enter, end_of_interval(2u * last.interval + 1u), ray_length,
                       skin);
            }
            if (is_opaque(beam)) last.interval = end - 1u;
            else if (inside.y > back_z) break;
        }
        beams[id] = vec4(beam.color, beam.opacity);
        last.depth = beam.depth;
        if (last.interval >= end) atomicAdd(done_pixels, 1u);  // integers: the order of the additions does not matter
    }
    lasts[id] = Last(here.value, here.weight, last.depth, last.interval - range.x);
#if SHADED || COLORED
    looks[id] = vec4(here.color, here.light, 0.0);
#endif
}
