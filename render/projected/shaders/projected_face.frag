#version 450
// SPDX-License-Identifier: Apache-2.0
// The crossing of a pixel's ray with a face. It is counted, and stored in the pixel's list if `keep` is set: by one
// program, so that what is stored was counted.
layout(location = 0) flat in vec4 corner0;
layout(location = 1) flat in vec4 corner1;
layout(location = 2) flat in vec4 corner2;
layout(location = 3) flat in uint rank;
layout(location = 4) flat in uint cover;  // 2 + tetrahedra on the side of the face's normal − those on the other

layout(std430, binding = 3) buffer Counts { uint counts[]; };
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 5) writeonly buffer Crossings { vec2 crossings[]; };  // depth, value
layout(std430, binding = 6) writeonly buffer Marks { uint marks[]; };  // 8 · rank + 2 + tetrahedra behind the face − before it
layout(location = 8) uniform bool keep;
layout(location = 7) uniform ivec4 rectangle;  // whose pixels are counted or kept

void main() {
    vec2 slope = (gl_FragCoord.xy - middle_px) * vec2(pixel, -pixel);
    vec2 q0 = off_ray(slope, corner0), q1 = off_ray(slope, corner1), q2 = off_ray(slope, corner2);
    bool s01, s02, s12;
    float a01 = doubled_area(q0, q1, s01), a02 = doubled_area(q0, q2, s02), a12 = doubled_area(q1, q2, s12);
    if (s01 != s12 || s01 == s02) discard;
    vec2 here = crossing(corner0.zw, corner1.zw, corner2.zw, a12, a02, a01);
    if (perspective && here.x < -middle_depth) discard;  // behind the eye
    ivec2 place = ivec2(gl_FragCoord.xy) - rectangle.xy;
    int id = place.y * (rectangle.z - rectangle.x) + place.x;
    uint before = atomicAdd(counts[id], 1u);
    if (!keep) return;
    uint behind = s01 ? 4u - cover : cover;  // to the left: the normal points towards the eye
    uint to = offsets[id] + before;
    if (to >= offsets[id + 1]) return;  // was not counted
    crossings[to] = here;
    marks[to] = 8u * rank + behind;
}
