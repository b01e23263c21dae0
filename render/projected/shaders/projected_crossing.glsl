// SPDX-License-Identifier: Apache-2.0
// Which faces the ray of a pixel crosses, and where. This follows from the edges alone, and all faces about an edge compute the
// same for it, so nothing is lost or counted twice between neighbours. The same as tets/ray_plane.h, in single precision.

// The offset from the ray, in the plane across the view.
vec2 off_ray(vec2 slope, vec4 corner) {
    precise vec2 q = corner.xy - (perspective ? slope * (middle_depth + corner.z) : slope);
    return q;
}

// The product of two floats without rounding: fraction · 2^power with 48 bits, of which the first is set; all are 0 for zero.
struct Product {
    int sign, power;
    uint high, low;
};

Product exact_product(float a, float b) {
    uint x = floatBitsToUint(a), y = floatBitsToUint(b);
    int x_power = int(x >> 23 & 0xffu), y_power = int(y >> 23 & 0xffu);
    if (x_power == 0 || y_power == 0) return Product(0, 0, 0u, 0u);  // what is below the normal numbers may count as zero
    Product p = Product((x ^ y) >> 31 == 0u ? 1 : -1, x_power + y_power, 0u, 0u);
    umulExtended(x & 0x7fffffu | 0x800000u, y & 0x7fffffu | 0x800000u, p.high, p.low);
    if ((p.high & 0x8000u) == 0u) {
        p.high = p.high << 1 | p.low >> 31;
        p.low <<= 1;
        --p.power;
    }
    return p;
}

// −1, 0 or 1: whether a product is less than another one, equal or more.
int order_of(Product a, Product b) {
    if (a.sign != b.sign) return sign(a.sign - b.sign);
    if (a.power != b.power) return a.power < b.power ? -a.sign : a.sign;
    if (a.high != b.high) return a.high < b.high ? -a.sign : a.sign;
    return a.low == b.low ? 0 : a.low < b.low ? -a.sign : a.sign;
}

// Twice the area of (ray, a, b), and on which side the ray passes: to the left or to the right, never neither (`side_of` in
// ray_plane.h). Rounding may make the two products equal but does not exchange them.
float doubled_area(vec2 a, vec2 b, out bool left) {
    precise float one = a.x * b.y, other = b.x * a.y;
    left = one > other;
    if (one == other) {
        int exact = order_of(exact_product(a.x, b.y), exact_product(b.x, a.y));
        left = exact != 0 ? exact > 0 : a.y != b.y ? a.y > b.y : b.x >= a.x;
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
