#version 450
// SPDX-License-Identifier: Apache-2.0
// The triangle that is drawn for a face, and the data that its fragments need.
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };  // eye space, value in parts of the knots' range
layout(std430, binding = 1) readonly buffer Faces { uvec4 faces[]; };  // corners, ascending; 2 + change of cover
layout(std430, binding = 2) readonly buffer Order { uint order[]; };

// By ascending number, so that faces compute the same for an edge that they share.
layout(location = 0) flat out vec4 corner0;
layout(location = 1) flat out vec4 corner1;
layout(location = 2) flat out vec4 corner2;
layout(location = 3) flat out uint rank;  // position in the order, from front to back
layout(location = 4) flat out uint cover;

vec2 place_corner(vec3 p[3], int at) {
    vec2 q[3], result;
    if (find_places(p, q) && outline_corner(q, ivec4(0, 1, 2, 2), 3, at, result)) return result;
    vec2 low, high;
    find_rectangle(p, low, high);  // the triangle around that rectangle
    return vec2(at == 1 ? 2.0 * high.x - low.x : low.x, at == 2 ? 2.0 * high.y - low.y : low.y);
}

void main() {
    rank = uint(gl_VertexID / 3);
    uvec4 face = faces[order[rank]];
    corner0 = points[face.x];
    corner1 = points[face.y];
    corner2 = points[face.z];
    cover = face.w;
    vec3 p[3] = vec3[3](corner0.xyz, corner1.xyz, corner2.xyz);
    gl_Position = vec4(place_corner(p, gl_VertexID % 3) / size_px * 2.0 - 1.0, 0.0, 1.0);
}
