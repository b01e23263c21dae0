#version 450
// The silhouette of a tetrahedron, two triangles or one, and what its fragments need to know of it. The silhouette is drawn a
// little too large: fragments find out for themselves whether they are inside.
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };  // eye space, value in cells of the table
layout(std430, binding = 1) readonly buffer Tets { uvec4 tets[]; };  // corners, ascending
layout(std430, binding = 2) readonly buffer Order { uint order[]; };

flat out vec4 corner0, corner1, corner2, corner3;  // by ascending number: what tetrahedra share, they compute alike
flat out uint rank;                                // its place in the order, from back to front

const float kMargin_px = 0.0625;    // rasterisers round places to 1/256 px
const float kSharp = 0.005;         // 1 + cos between normals: corners that are sharper would reach 20 margins out
const float kSmall_px = 0.25;       // twice the area: what is smaller need not be cut to shape
const float kFar_px = 16384.0;      // from the middle: single precision still knows 1/256 px
const float kNearest = 1e-6;        // depth of what is projected

vec2 to_pixels(vec3 p) {
    float across = perspective ? middle_depth + p.z : 1.0;
    return middle_px + vec2(p.x, -p.y) / (across * pixel);
}

float doubled_area(vec2 a, vec2 b, vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// The rectangle about what is in front of the eye.
vec2 rectangle_corner(vec3 p[4], int at) {
    vec2 low = vec2(1e30), high = vec2(-1e30);
    for (int i = 0; i < 4; ++i) {
        float zi = middle_depth + p[i].z;
        if (!perspective || zi >= kNearest) {
            low = min(low, to_pixels(p[i]));
            high = max(high, to_pixels(p[i]));
            continue;
        }
        for (int k = 0; k < 4; ++k) {
            float zk = middle_depth + p[k].z;
            if (zk < kNearest) continue;
            vec2 cut = mix(p[i].xy, p[k].xy, (kNearest - zi) / (zk - zi));
            vec2 cut_px = middle_px + vec2(cut.x, -cut.y) / (kNearest * pixel);
            low = min(low, cut_px);
            high = max(high, cut_px);
        }
    }
    if (low.x > high.x) return vec2(-1.0);  // nothing is
    low = clamp(low - kMargin_px, vec2(-1.0), size_px + 1.0);
    high = clamp(high + kMargin_px, vec2(-1.0), size_px + 1.0);
    return vec2((at & 1) == 0 ? low.x : high.x, (at & 2) == 0 ? low.y : high.y);
}

// The silhouette's corners in their order about it; there are 3 or 4.
int find_silhouette(vec2 q[4], out ivec4 ring) {
    bvec4 left = bvec4(doubled_area(q[1], q[2], q[3]) > 0.0, doubled_area(q[0], q[3], q[2]) > 0.0,
                       doubled_area(q[0], q[1], q[3]) > 0.0, doubled_area(q[0], q[2], q[1]) > 0.0);
    int count = int(left.x) + int(left.y) + int(left.z) + int(left.w);
    if (count == 2) {  // an edge is seen from outside where two faces of different sides meet: opposite ones are of one side
        int other = left.y == left.x ? 1 : left.z == left.x ? 2 : 3;
        int second = other == 1 ? 2 : 1, last = other == 3 ? 2 : 3;
        ring = ivec4(0, second, other, last);
        return 4;
    }
    bool lone = count == 1;  // the face that is alone on its side covers the other three
    int inner = left.x == lone ? 0 : left.y == lone ? 1 : left.z == lone ? 2 : 3;
    ring = ivec4(inner == 0 ? 1 : 0, inner <= 1 ? 2 : 1, inner <= 2 ? 3 : 2, inner);
    return 3;
}

// A corner of the silhouette with its edges moved outwards; false if it is too sharp for that.
bool move_out(vec2 before, vec2 here, vec2 after, float turn, out vec2 moved) {
    vec2 a = here - before, b = after - here;
    vec2 na = turn * vec2(a.y, -a.x) / length(a), nb = turn * vec2(b.y, -b.x) / length(b);
    float sharp = 1.0 + dot(na, nb);
    moved = here + (na + nb) * (kMargin_px / sharp);
    return sharp > kSharp;  // NaN is not
}

vec2 place_corner(vec3 p[4], int at) {
    vec2 q[4];
    bool hull = true;
    for (int i = 0; i < 4; ++i) {
        q[i] = to_pixels(p[i]);
        hull = hull && !(perspective && middle_depth + p[i].z < kNearest) && all(lessThan(abs(q[i] - middle_px), vec2(kFar_px)));
    }
    if (!hull) return rectangle_corner(p, at);
    ivec4 ring;
    int count = find_silhouette(q, ring);
    float area = doubled_area(q[ring.x], q[ring.y], q[ring.z]);
    if (count == 4) area += doubled_area(q[ring.x], q[ring.z], q[ring.w]);
    if (abs(area) < kSmall_px) return rectangle_corner(p, at);
    float turn = area > 0.0 ? 1.0 : -1.0;
    const int corners[4] = int[4](0, 1, 3, 2);  // strip to ring
    vec2 result = vec2(0.0);
    for (int i = 0; i < count; ++i) {
        int before = (i + count - 1) % count, after = (i + 1) % count;
        vec2 moved;
        if (!move_out(q[ring[before]], q[ring[i]], q[ring[after]], turn, moved)) return rectangle_corner(p, at);
        if (i == min(corners[at], count - 1)) result = moved;
    }
    return result;
}

void main() {
    rank = uint(gl_VertexID / 6);
    uvec4 corners = tets[order[rank]];
    corner0 = points[corners.x];
    corner1 = points[corners.y];
    corner2 = points[corners.z];
    corner3 = points[corners.w];
    vec3 p[4] = vec3[4](corner0.xyz, corner1.xyz, corner2.xyz, corner3.xyz);
    int turn = gl_VertexID % 6, at = turn < 3 ? turn : turn - 2;  // corners 0 1 2, 1 2 3
    gl_Position = vec4(place_corner(p, at) / size_px * 2.0 - 1.0, 0.0, 1.0);
}
