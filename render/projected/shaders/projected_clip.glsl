// SPDX-License-Identifier: Apache-2.0
// What a clip leaves of a segment. Planes are {normal, offset} in the units of projected_frame.glsl; faces remove places where
// normal · place + offset > 0. The rays of a pixel may end at a depth.
#if CLIPPED
layout(std430, binding = 9) readonly buffer Cuts { vec4 cuts[]; };  // faces, slices, four ends of rays in each
layout(location = 5) uniform ivec2 plane_counts;
layout(location = 6) uniform bool slices_alone;

// On the ray of a pixel the height above a plane is slope.y + slope.x · depth.
vec2 height_along(vec4 plane, vec2 slope) {
    float across = dot(plane.xy, slope);
    return perspective ? vec2(across + plane.z, across * middle_depth + plane.w) : vec2(plane.z, across + plane.w);
}

vec2 cut_at(float depth, vec2 front, vec2 back) {
    float part = front.x < back.x ? clamp((depth - front.x) / (back.x - front.x), 0.0, 1.0) : 0.0;
    return vec2(depth, mix(front.y, back.y, part));
}

#if RAYS_END
float ray_end(vec2 slope) {
    ivec2 at = clamp(ivec2(floor(middle_px + vec2(slope.x, -slope.y) / pixel)), ivec2(0), ivec2(size_px) - 1);
    int number = at.y * int(size_px.x) + at.x;
    return cuts[plane_counts.x + plane_counts.y + number / 4][number % 4];
}
#endif

// Shortens a segment between two depths with values, which change places if nothing is left; false if the whole ray is removed.
bool clip_segment(vec2 slope, inout vec2 front, inout vec2 back) {
    for (int i = 0; i < plane_counts.x; ++i) {
        vec2 height = height_along(cuts[i], slope);
        if (height.x == 0.0) {
            if (height.y > 0.0) return false;
            continue;
        }
        float depth = -height.y / height.x;
        if (height.x > 0.0 && depth < back.x) back = cut_at(depth, front, back);
        if (height.x < 0.0 && depth > front.x) front = cut_at(depth, front, back);
    }
#if RAYS_END
    float end = ray_end(slope);
    if (end < back.x) back = cut_at(end, front, back);
#endif
    return true;
}

// The light of what is left of a segment, with the first slice that belongs to it by the rule of RaySlice (ray_clip.h).
vec4 visible_light(vec2 slope, vec2 front, vec2 back, float ray_length) {
    if (!clip_segment(slope, front, back)) return vec4(0.0);
    bool sliced = false;
    for (int i = 0; i < plane_counts.y; ++i) {
        vec2 height = height_along(cuts[plane_counts.x + i], slope);
        if (!(abs(height.x) > kSliceTolerance)) continue;
        float depth = -height.y / height.x, tolerance = kSliceTolerance / abs(height.x);
        if (!(middle_depth + depth > tolerance)) continue;
        if (!(depth >= front.x - tolerance && depth <= back.x + tolerance)) continue;
        back = cut_at(min(max(depth, front.x), back.x), front, back);
        sliced = true;
    }
    vec4 light = vec4(0.0);
    if (!slices_alone && back.x > front.x) light = segment_light(front.y, back.y, (back.x - front.x) * ray_length);
    if (sliced) light += (1.0 - light.a) * vec4(rgba_at(knots_up_to(back.y), back.y).rgb, 1.0);
    return light;
}
#else
vec4 visible_light(vec2 slope, vec2 front, vec2 back, float ray_length) {
    return segment_light(front.y, back.y, (back.x - front.x) * ray_length);
}
#endif
