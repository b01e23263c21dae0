// SPDX-License-Identifier: Apache-2.0
// Outlines of tetrahedra and faces in the picture. They are drawn a little too large; each fragment tests whether its ray
// crosses.
const float kMargin_px = 0.0625;    // rasterisers round places to 1/256 px
const float kSharp = 0.005;         // 1 + cos between normals: sharper corners would reach out by 20 margins
const float kSmall_px = 0.25;       // twice the area: for smaller outlines a rectangle will do
const float kFar_px = 16384.0;      // from the middle: up to here single precision resolves 1/256 px
const float kNearest = 1e-6;        // the least depth that is projected

vec2 to_pixels(vec3 p) {
    float across = perspective ? middle_depth + p.z : 1.0;
    return middle_px + vec2(p.x, -p.y) / (across * pixel);
}

float doubled_area(vec2 a, vec2 b, vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// The rectangle around the part in front of the eye.
void find_rectangle(vec3 p[kCorners], out vec2 low, out vec2 high) {
    low = vec2(1e30);
    high = vec2(-1e30);
    for (int i = 0; i < kCorners; ++i) {
        float zi = middle_depth + p[i].z;
        if (!perspective || zi >= kNearest) {
            low = min(low, to_pixels(p[i]));
            high = max(high, to_pixels(p[i]));
            continue;
        }
        for (int k = 0; k < kCorners; ++k) {
            float zk = middle_depth + p[k].z;
            if (zk < kNearest) continue;
            vec2 cut = mix(p[i].xy, p[k].xy, (kNearest - zi) / (zk - zi));
            vec2 cut_px = middle_px + vec2(cut.x, -cut.y) / (kNearest * pixel);
            low = min(low, cut_px);
            high = max(high, cut_px);
        }
    }
    if (low.x > high.x) low = high = vec2(-1.0);  // nothing is in front
    low = clamp(low - kMargin_px, vec2(-1.0), size_px + 1.0);
    high = clamp(high + kMargin_px, vec2(-1.0), size_px + 1.0);
}

// The corners in the picture; false if one is behind the eye or too far out.
bool find_places(vec3 p[kCorners], out vec2 q[kCorners]) {
    bool use = true;
    for (int i = 0; i < kCorners; ++i) {
        q[i] = to_pixels(p[i]);
        use = use && !(perspective && middle_depth + p[i].z < kNearest) && all(lessThan(abs(q[i] - middle_px), vec2(kFar_px)));
    }
    return use;
}

// A corner of the outline with its edges moved outwards; false if it is too sharp for that.
bool move_out(vec2 before, vec2 here, vec2 after, float turn, out vec2 moved) {
    vec2 a = here - before, b = after - here;
    vec2 na = turn * vec2(a.y, -a.x) / length(a), nb = turn * vec2(b.y, -b.x) / length(b);
    float sharp = 1.0 + dot(na, nb);
    moved = here + (na + nb) * (kMargin_px / sharp);
    return sharp > kSharp;  // false for NaN
}

// A corner of an outline of 3 or 4, moved outwards; false if one of its corners is too sharp.
bool outline_corner(vec2 q[kCorners], ivec4 ring, int count, int at, out vec2 result) {
    result = vec2(0.0);
    float area = doubled_area(q[ring.x], q[ring.y], q[ring.z]);
    if (count == 4) area += doubled_area(q[ring.x], q[ring.z], q[ring.w]);
    if (abs(area) < kSmall_px) return false;
    float turn = area > 0.0 ? 1.0 : -1.0;
    for (int i = 0; i < count; ++i) {
        int before = (i + count - 1) % count, after = (i + 1) % count;
        vec2 moved;
        if (!move_out(q[ring[before]], q[ring[i]], q[ring[after]], turn, moved)) return false;
        if (i == at) result = moved;
    }
    return true;
}
