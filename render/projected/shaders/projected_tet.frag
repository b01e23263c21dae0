#version 450
// SPDX-License-Identifier: Apache-2.0
// The segment of a pixel's ray in a tetrahedron. FRAGMENT_COMPOSITE blends it over what was drawn before, FRAGMENT_LISTS counts
// it, and stores it in the pixel's list if `keep` is set. Both are done by one program, so that what is stored was counted.
layout(location = 0) flat in vec4 corner0;
layout(location = 1) flat in vec4 corner1;
layout(location = 2) flat in vec4 corner2;
layout(location = 3) flat in vec4 corner3;
layout(location = 4) flat in uint rank;

#if FRAGMENT_MODE == FRAGMENT_COMPOSITE
layout(location = 0) out vec4 color;
#else
layout(std430, binding = 3) buffer Counts { uint counts[]; };
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 5) writeonly buffer Segments { vec4 segments[]; };  // depths of both ends, values there
layout(std430, binding = 6) writeonly buffer Ranks { uint ranks[]; };
layout(location = 8) uniform bool keep;
#endif
layout(location = 7) uniform ivec4 rectangle;  // whose pixels are counted or kept

// The ends of the segment; false if the ray does not meet the tetrahedron.
bool find_segment(vec2 slope, out vec2 front, out vec2 back) {
    vec2 q0 = off_ray(slope, corner0), q1 = off_ray(slope, corner1), q2 = off_ray(slope, corner2), q3 = off_ray(slope, corner3);
    bool s01, s02, s03, s12, s13, s23;
    float a01 = doubled_area(q0, q1, s01), a02 = doubled_area(q0, q2, s02), a03 = doubled_area(q0, q3, s03);
    float a12 = doubled_area(q1, q2, s12), a13 = doubled_area(q1, q3, s13), a23 = doubled_area(q2, q3, s23);
    // A face is crossed if its edges go round the ray. This holds for two faces or for none.
    bool c123 = s12 == s23 && s12 != s13, c023 = s02 == s23 && s02 != s03;
    bool c013 = s01 == s13 && s01 != s03, c012 = s01 == s12 && s01 != s02;
    if (int(c123) + int(c023) + int(c013) + int(c012) != 2) return false;
    vec2 f123 = crossing(corner1.zw, corner2.zw, corner3.zw, a23, a13, a12);
    vec2 f023 = crossing(corner0.zw, corner2.zw, corner3.zw, a23, a03, a02);
    vec2 f013 = crossing(corner0.zw, corner1.zw, corner3.zw, a13, a03, a01);
    vec2 f012 = crossing(corner0.zw, corner1.zw, corner2.zw, a12, a02, a01);
    vec2 one = c123 ? f123 : c023 ? f023 : f013, other = c012 ? f012 : c013 ? f013 : f023;
    front = one.x < other.x ? one : other;
    back = one.x < other.x ? other : one;
    float eye = -middle_depth;  // nothing behind the eye is seen
    if (front.x < eye && back.x > eye) front = vec2(eye, mix(front.y, back.y, (eye - front.x) / (back.x - front.x)));
    return front.x >= eye && front.x < back.x;
}

void main() {
    vec2 slope = (gl_FragCoord.xy - middle_px) * vec2(pixel, -pixel), front, back;
    if (!find_segment(slope, front, back)) discard;
#if FRAGMENT_MODE == FRAGMENT_COMPOSITE
    float ray_length = perspective ? sqrt(1.0 + dot(slope, slope)) : 1.0;
    color = visible_light(slope, front, back, ray_length);
#else
    ivec2 place = ivec2(gl_FragCoord.xy) - rectangle.xy;
    int id = place.y * (rectangle.z - rectangle.x) + place.x;
    uint before = atomicAdd(counts[id], 1u);
    if (!keep) return;
    uint to = offsets[id] + before;
    if (to >= offsets[id + 1]) return;  // was not counted
    segments[to] = vec4(front.x, back.x, front.y, back.y);
    ranks[to] = rank;
#endif
}
