// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <span>

#include "model_block.h"
#include "subvol/detail/solid_field.h"

namespace subvol::detail::model {

// Shapes for constructive solid geometry, as functions of a place relative to the shape's centre: about a signed distance,
// positive inside, with slope 1 at the surface. Axes are counted from 0.

[[nodiscard]] double ball(const Vec3& q, double radius);
[[nodiscard]] double ellipsoid(const Vec3& q, const Vec3& radii);
/// rounding: radius of the edges
[[nodiscard]] double box(const Vec3& q, const Vec3& half, double rounding = 1);
[[nodiscard]] double cylinder(const Vec3& q, int axis, double radius, double half, double rounding = 1);
/// A torus: a tube about the circle in the plane across `axis`.
[[nodiscard]] double ring(const Vec3& q, int axis, double radius, double tube);
/// A rod from a to b with round ends; its radius changes linearly from radius_a to radius_b.
[[nodiscard]] double rod(const Vec3& q, const Vec3& a, const Vec3& b, double radius_a, double radius_b);
/// The half-space behind a plane through the origin. normal: outward, any length
[[nodiscard]] double behind(const Vec3& q, const Vec3& normal);

/// A ball by the squared distance from its centre, or a slab by that from its middle: with slope 1 at the surface, and smooth
/// at the centre too, for it is a polynomial.
[[nodiscard]] double within(double squared_distance, double radius);

/// Union (join), intersection (meet) and difference (cut) of shapes with rounded edges, by log-sum-exp.
struct Blend {
    double rounding;  ///< the size of the rounded edges, in the unit of the shapes

    [[nodiscard]] double join(std::initializer_list<double> shapes) const;
    [[nodiscard]] double meet(std::initializer_list<double> shapes) const;
    [[nodiscard]] double cut(double shape, double tool) const { return meet({shape, -tool}); }
};

/// A solid in a straight block of cells that is then deformed.
struct Solid {
    double (*distance)(const Vec3& q);         ///< about a signed distance of a place in the straight block, positive inside
    double transition;                         ///< the density is tanh(distance / transition)
    Vec3 half;                                 ///< half the block's edges; its cells are about cubes
    int main;                                  ///< the axis along which the resolution counts cells
    std::span<const Deformation> deformation;  ///< of the straight block; its Jacobian is positive there
};

// For most solids the unit of length is a cell of the block at its default resolution. The density goes from -.76 to .76 over
// four cells and edges are rounded, so that the cells resolve the surface; parts are at least three cells thick.
inline constexpr double kCellTransition = 1.9;
inline constexpr Blend kCellBlend{.rounding = 0.64};

/// resolution: cells along solid.main; along the other axes in proportion, at least 1
[[nodiscard]] HexMesh make_solid(const Solid& solid, Index resolution);

}  // namespace subvol::detail::model
