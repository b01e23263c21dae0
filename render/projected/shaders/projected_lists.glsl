// SPDX-License-Identifier: Apache-2.0
// The lists of a part of the picture: what all of its shaders know. A list may have any length, so a dispatch does a limited
// number of steps for each pixel, keeps the state, and is repeated while pixels are unfinished: drivers end loops, or reset the
// device, if one takes too long.
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 11) buffer Counters { uint wrong_pixels, late_faces, unfinished; };
layout(location = 7) uniform ivec4 rectangle;
layout(location = 8) uniform bool resumed;
layout(location = 9) uniform uint list_steps;  // a dispatch ends soon after so many for each pixel

const uint kListThreads = 64u;
#if CLIPPED
#define kSegmentSteps (1u + uint(plane_counts.x + plane_counts.y))  // besides those that the integration counts
#else
#define kSegmentSteps 1u
#endif

uint thread_number() { return gl_WorkGroupID.y * gl_NumWorkGroups.x * kListThreads + gl_GlobalInvocationID.x; }

uint list_count() { return uint(rectangle.z - rectangle.x) * uint(rectangle.w - rectangle.y); }

vec2 slope_of(uint pixel_id) {
    uint width = uint(rectangle.z - rectangle.x);
    return (vec2(rectangle.xy) + vec2(pixel_id % width, pixel_id / width) + 0.5 - middle_px) * vec2(pixel, -pixel);
}
