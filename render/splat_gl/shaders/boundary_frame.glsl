// SPDX-License-Identifier: Apache-2.0
// The rules of splat/boundary_intervals.cpp, bit for bit: coverage must not depend on rounding, so every number that decides
// about it is `precise` or an integer.
layout(std140, binding = 1) uniform Camera {
    dvec4 right, up, forward;  // the last components: the eye's x, y, z
    dvec4 scale;               // pixel, middle depth, near depth relative to it
    ivec2 size;
    bool perspective;
    uint points, triangles, most_hits;
};

struct EyePoint {
    double x, y, z;
    ivec2 px;  // in 1/4096 px
};

const int kSnap = 4096;
const int kStrip_px = 32;  // the pixels of a row that a thread works on at a time
const uint kMostHits = 128u;  // that a thread sorts
const uint kMostStrips = 1u << 24;  // of all triangles: more would keep the device busy for too long

// The 64-bit product (a − o) × (b − o), of which the sign gives the side on which a point lies.
struct Product {
    int high;
    uint low;
};

Product product(int a, int b) {
    Product p;
    int low;
    imulExtended(a, b, p.high, low);
    p.low = uint(low);
    return p;
}
bool same_product(Product a, Product b) { return a.high == b.high && a.low == b.low; }
bool less_product(Product a, Product b) { return a.high < b.high || (a.high == b.high && a.low < b.low); }
