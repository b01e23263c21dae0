// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "subvol/camera.h"
#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// A mesh point in the coordinates of a ray: (x,y) is its offset from the ray in the plane across the dominant axis, t its
/// place along the ray.
struct SeenPoint {
    Index id = kNone;
    double x = 0, y = 0, t = 0;
    double value = 0;
};

/// Twice the signed area of (ray, a, b), and its sign: on which side of the edge ab the ray passes. The sign is exact for the
/// seen coordinates and never zero: ties are decided as if the ray were moved by (ε, ε²) [em1990], and by ids between points
/// that coincide for the ray. So the signs of all edges are consistent, and every ray crosses the inside of faces, even through
/// a vertex or along an edge.
struct Side {
    double area = 0;
    bool left = false;

    [[nodiscard]] Side reversed() const { return {-area, !left}; }
};

/// Shears space so that the ray becomes the t axis.
class RayPlane {
public:
    explicit RayPlane(const Ray& ray) : origin_(ray.origin) {
        const Vec3 size = glm::abs(ray.direction);
        z_ = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
        x_ = (z_ + 1) % 3;
        y_ = (z_ + 2) % 3;
        per_depth_ = 1 / ray.direction[z_];
        slope_x_ = ray.direction[x_] * per_depth_;
        slope_y_ = ray.direction[y_] * per_depth_;
    }

    [[nodiscard]] SeenPoint see(Index id, const Vec3& position, double value) const {
        const Vec3 p = position - origin_;
        return {id, p[x_] - slope_x_ * p[z_], p[y_] - slope_y_ * p[z_], p[z_] * per_depth_, value};
    }

    /// False if the line certainly misses a box that is widened by `margin`.
    [[nodiscard]] bool may_meet(const Vec3& center, const Vec3& half, double margin) const {
        const Vec3 p = center - origin_;
        const double x = p[x_] - slope_x_ * p[z_], y = p[y_] - slope_y_ * p[z_];
        const double size_x = std::abs(slope_x_), size_y = std::abs(slope_y_);
        return std::abs(x) <= half[x_] + size_x * half[z_] + margin && std::abs(y) <= half[y_] + size_y * half[z_] + margin &&
               std::abs(x * slope_y_ - y * slope_x_) <= half[x_] * size_y + half[y_] * size_x + margin;
    }
    [[nodiscard]] const Vec3& origin() const { return origin_; }

    /// The axes of space that become x, y and depth, and their shear.
    [[nodiscard]] std::array<int, 3> axes() const { return {x_, y_, z_}; }
    [[nodiscard]] double slope_x() const { return slope_x_; }
    [[nodiscard]] double slope_y() const { return slope_y_; }
    [[nodiscard]] double per_depth() const { return per_depth_; }

private:
    Vec3 origin_;
    int x_, y_, z_;
    double slope_x_, slope_y_, per_depth_;
};

/// a·d − b·c with a relative error of at most two roundings, hence with the right sign: Kahan's algorithm (Jeannerod, Louvet,
/// Muller 2013).
[[nodiscard]] inline double exact_difference(double a, double d, double b, double c) {
    const double bc = b * c;
    return std::fma(a, d, -bc) + std::fma(-b, c, bc);
}

/// An area larger than this share of its terms is used as it was rounded, a smaller one is computed exactly. For the sign alone
/// 3.4e-16 would do ((3 + 16ε)ε of Shewchuk's 2-D orientation test). But areas are also the weights of a crossing: without
/// right digits the crossing would lie beside the ray, by up to the whole face where it is seen almost edge on.
inline constexpr double kSideError = 1e-7;

[[nodiscard]] inline Side side_of(const SeenPoint& a, const SeenPoint& b) {
    const double left = a.x * b.y, right = b.x * a.y;
    const double area = left - right;
    if (std::abs(area) > kSideError * (std::abs(left) + std::abs(right))) return {area, area > 0};
    const double exact = exact_difference(a.x, b.y, b.x, a.y);
    if (exact != 0) return {exact, exact > 0};
    if (a.y != b.y) return {0, a.y > b.y};
    if (a.x != b.x) return {0, b.x > a.x};
    return {0, a.id < b.id};
}

}  // namespace subvol::detail
