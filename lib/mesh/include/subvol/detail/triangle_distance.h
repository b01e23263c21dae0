// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "subvol/vec.h"

namespace subvol::detail {

/// The squared distance from p to a segment, which may be a point.
[[nodiscard]] inline double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 ab = b - a, ap = p - a;
    const double length2 = glm::dot(ab, ab);
    const Vec3 off = ap - (length2 > 0 ? std::clamp(glm::dot(ap, ab) / length2, 0.0, 1.0) : 0.0) * ab;
    return glm::dot(off, off);
}

/// The place of a triangle that is nearest to a point: its barycentric weights, and whether it lies inside the triangle.
struct NearestInTriangle {
    Vec3 weights{1, 0, 0};
    bool inside = false;
};

/// The face, edge or corner whose Voronoi region contains p. A triangle without area is its edges.
///
/// source: [ericson2005], section 5.1.5
[[nodiscard]] inline NearestInTriangle nearest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return {{1, 0, 0}};
    const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return {{0, 1, 0}};
    // An edge of length 0 has no region of its own: for ab, d1 = d3.
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return {{1 - d1 / (d1 - d3), d1 / (d1 - d3), 0}};
    const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return {{0, 0, 1}};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return {{1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)}};
    const double va = d3 * d6 - d5 * d4, along_b = d4 - d3, along_c = d5 - d6;
    if (va <= 0 && along_b >= 0 && along_c >= 0 && along_b + along_c > 0) {
        const double t = along_b / (along_b + along_c);
        return {{0, 1 - t, t}};
    }
    const double sum = va + vb + vc;
    if (sum > 0) return {{va / sum, vb / sum, vc / sum}, true};
    // Rounding left no area: the nearest of the corners.
    const double to_a = glm::dot(ap, ap), to_b = glm::dot(bp, bp), to_c = glm::dot(cp, cp);
    if (to_a <= to_b && to_a <= to_c) return {{1, 0, 0}};
    return to_b <= to_c ? NearestInTriangle{{0, 1, 0}} : NearestInTriangle{{0, 0, 1}};
}

/// The squared distance from p to a triangle. One without area is its edges.
[[nodiscard]] inline double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    const Vec3 normal = glm::cross(ab, ac);
    const double area2 = glm::dot(normal, normal);
    if (!(area2 > 0)) return std::min({squared_distance(p, a, b), squared_distance(p, b, c), squared_distance(p, c, a)});
    const NearestInTriangle nearest = nearest_in_triangle(p, a, b, c);
    if (nearest.inside) {
        const double height = glm::dot(normal, ap);
        return height * height / area2;
    }
    const Vec3 off = ap - nearest.weights.y * ab - nearest.weights.z * ac;
    return glm::dot(off, off);
}

}  // namespace subvol::detail
