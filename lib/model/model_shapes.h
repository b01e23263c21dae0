// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>

#include "subvol/vec.h"

namespace subvol::model {

// Solids for constructive geometry, as functions of a place relative to the solid's centre: like a signed distance, positive
// inside, with slope 1 at the surface. Axes are counted from 0.

[[nodiscard]] double ball(const Vec3& q, double radius);
[[nodiscard]] double ellipsoid(const Vec3& q, const Vec3& radii);
/// rounding: radius of the edges
[[nodiscard]] double box(const Vec3& q, const Vec3& half, double rounding = 1);
[[nodiscard]] double cylinder(const Vec3& q, int axis, double radius, double half, double rounding = 1);
/// A torus: a tube about the circle in the plane across `axis`.
[[nodiscard]] double ring(const Vec3& q, int axis, double radius, double tube);
/// A rod from a to b with round ends, its radius going from one to the other.
[[nodiscard]] double rod(const Vec3& q, const Vec3& a, const Vec3& b, double radius_a, double radius_b);
/// What lies behind a plane. normal: outward, any length
[[nodiscard]] double behind(const Vec3& q, const Vec3& normal);

/// Like a signed distance, with slope 1 at the surface; a polynomial, so smooth at the centre too.
[[nodiscard]] double within(double squared_distance, double radius);

/// Joins and cuts solids with rounded edges (log-sum-exp). rounding: their size, in the unit of the solids
struct Blend {
    double rounding;

    [[nodiscard]] double join(std::initializer_list<double> solids) const;
    [[nodiscard]] double meet(std::initializer_list<double> solids) const;
    [[nodiscard]] double cut(double solid, double tool) const { return meet({solid, -tool}); }
};

}  // namespace subvol::model
