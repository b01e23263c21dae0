// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "subvol/vec.h"

namespace subvol::detail {

/// The half space normal·x + offset ≥ 0 is kept.
struct ClipPlane {
    Vec3 normal;
    double offset;
};

/// Clips a convex polygon by a plane. An edge is cut at bitwise the same point in either direction, so that neighbours that
/// share it stay connected.
inline void clip_polygon(std::vector<Vec3>& polygon, const ClipPlane& plane, std::vector<Vec3>& scratch) {
    const auto height = [&](const Vec3& p) { return glm::dot(plane.normal, p) + plane.offset; };
    const auto less = [](const Vec3& a, const Vec3& b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; };
    scratch.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double ha = height(a), hb = height(b);
        if (ha >= 0) scratch.push_back(a);
        if ((ha >= 0) == (hb >= 0)) continue;
        const bool forward = less(a, b);
        const Vec3 &p = forward ? a : b, &q = forward ? b : a;
        const double hp = forward ? ha : hb, hq = forward ? hb : ha;
        scratch.push_back(p + (q - p) * (hp / (hp - hq)));
    }
    polygon.swap(scratch);
}

}  // namespace subvol::detail
