// SPDX-License-Identifier: Apache-2.0
// Which faces the ray of a pixel crosses, and where. It follows from the edges alone, and an edge is the same to every face that
// has it: so nothing is lost or counted twice between neighbours (ray_plane.h, in single precision).

// Off the ray, in the plane across the view.
vec2 off_ray(vec2 slope, vec4 corner) {
    precise vec2 q = corner.xy - (perspective ? slope * (middle_depth + corner.z) : slope);
    return q;
}

// Twice the area of (ray, a, b), and whether that is to the left; never neither: SeenPoint's side_of. Rounding of the products
// may make them equal but does not exchange them.
float doubled_area(vec2 a, vec2 b, out bool left) {
    precise float one = a.x * b.y, other = b.x * a.y;
    left = one > other;
    if (one == other) {
        double exact_one = double(a.x) * double(b.y), exact_other = double(b.x) * double(a.y);
        left = exact_one != exact_other ? exact_one > exact_other : a.y != b.y ? a.y > b.y : b.x >= a.x;
    }
    return abs(one - other);
}

// Depth and value where the ray crosses a face; the areas are the barycentric weights.
vec2 crossing(vec2 a, vec2 b, vec2 c, float wa, float wb, float wc) {
    precise float sum = wa + wb + wc;
    if (!(sum > 0.0)) return (a + b + c) / 3.0;  // seen edge on, to the last bit
    precise vec2 result = (wa * a + wb * b + wc * c) / sum;
    return result;
}
