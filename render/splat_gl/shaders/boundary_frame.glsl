// SPDX-License-Identifier: Apache-2.0
// The rules of boundary_intervals.cpp, bit for bit: where pixels are covered no rounding may differ, so every number that
// decides it is `precise` or whole.
layout(std140, binding = 1) uniform Camera {
    dvec4 right, up, forward;  // the last parts: the eye's x, y, z
    dvec4 scale;               // pixel, middle depth, near depth from there
    ivec2 size;
    bool perspective;
    uint points, triangles, most_hits;
};

struct EyePoint {
    double x, y, z;
    ivec2 px;  // in 1/4096
};

const int kSnap = 4096;
const int kStrip_px = 32;  // pixels of a row that a thread looks at

// The 64 bits of (a − o) × (b − o): compared, they say on which side a point lies.
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
