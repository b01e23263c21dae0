#version 450
// SPDX-License-Identifier: Apache-2.0
// The silhouette of a tetrahedron, two triangles or one, and the data that its fragments need.
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };  // eye space, value in parts of the knots' range
layout(std430, binding = 1) readonly buffer Tets { uvec4 tets[]; };  // corners, ascending
layout(std430, binding = 2) readonly buffer Order { uint order[]; };

// By ascending number, so that tetrahedra compute the same for an edge that they share.
layout(location = 0) flat out vec4 corner0;
layout(location = 1) flat out vec4 corner1;
layout(location = 2) flat out vec4 corner2;
layout(location = 3) flat out vec4 corner3;
layout(location = 4) flat out uint rank;  // position in the order, from back to front
#if FRAGMENT_MODE != FRAGMENT_COMPOSITE
layout(location = 9) uniform uint last_rank;  // lists are drawn from front to back, as they are sorted
#endif

// The 3 or 4 corners of the silhouette in order.
int find_silhouette(vec2 q[4], out ivec4 ring) {
    bvec4 left = bvec4(doubled_area(q[1], q[2], q[3]) > 0.0, doubled_area(q[0], q[3], q[2]) > 0.0,
                       doubled_area(q[0], q[1], q[3]) > 0.0, doubled_area(q[0], q[2], q[1]) > 0.0);
    int count = int(left.x) + int(left.y) + int(left.z) + int(left.w);
    if (count == 2) {  // an edge is on the silhouette where a front and a back face meet
        int other = left.y == left.x ? 1 : left.z == left.x ? 2 : 3;
        int second = other == 1 ? 2 : 1, last = other == 3 ? 2 : 3;
        ring = ivec4(0, second, other, last);
        return 4;
    }
    bool lone = count == 1;  // the one face that is alone on its side covers the other three
    int inner = left.x == lone ? 0 : left.y == lone ? 1 : left.z == lone ? 2 : 3;
    ring = ivec4(inner == 0 ? 1 : 0, inner <= 1 ? 2 : 1, inner <= 2 ? 3 : 2, inner);
    return 3;
}

vec2 place_corner(vec3 p[4], int at) {
    const int corners[4] = int[4](0, 1, 3, 2);  // from the order of a strip to that of a ring
    vec2 q[4], result;
    if (find_places(p, q)) {
        ivec4 ring;
        int count = find_silhouette(q, ring);
        if (outline_corner(q, ring, count, min(corners[at], count - 1), result)) return result;
    }
    vec2 low, high;
    find_rectangle(p, low, high);
    return vec2((at & 1) == 0 ? low.x : high.x, (at & 2) == 0 ? low.y : high.y);
}

void main() {
    rank = uint(gl_VertexID / 6);
#if FRAGMENT_MODE != FRAGMENT_COMPOSITE
    rank = last_rank - rank;
#endif
    uvec4 corners = tets[order[rank]];
    corner0 = points[corners.x];
    corner1 = points[corners.y];
    corner2 = points[corners.z];
    corner3 = points[corners.w];
    vec3 p[4] = vec3[4](corner0.xyz, corner1.xyz, corner2.xyz, corner3.xyz);
    int turn = gl_VertexID % 6, at = turn < 3 ? turn : turn - 2;  // corners 0 1 2, 1 2 3
    gl_Position = vec4(place_corner(p, at) / size_px * 2.0 - 1.0, 0.0, 1.0);
}
