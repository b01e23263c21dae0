// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/limit_surface.h"

namespace subvol::detail {

/// Fills in area, volume, watertight, euler, components and angles.
void measure_surface(const Surface& surface, SurfaceReport& report);

/// The lines along which a surface is sharp, or ends: creases, where a cap meets its isosurface, borders.
struct SharpLines {
    std::vector<std::array<Index, 2>> next;  ///< for each point the points before and behind it on a line; kNone: it is on none
    std::vector<std::uint8_t> fixed;         ///< points where lines end or meet
};

/// hull: of each triangle, whether it is part of the hull
[[nodiscard]] SharpLines sharp_lines(const std::vector<Vec3>& points, const std::vector<std::array<Index, 3>>& triangles,
                                     std::span<const std::uint8_t> hull);

/// The smallest angle of a triangle, in degrees.
[[nodiscard]] double least_angle_deg(const Vec3& a, const Vec3& b, const Vec3& c);

/// How far the surface may change where slivers are mended.
struct MendSlack {
    double world = 0;        ///< new edges may bend away from the limit by so much, by the normals
    double near_world = 0;   ///< points that go pass the surface within this distance, where normals do not show that
    bool by_normals = true;  ///< normals show it, but at sharp lines
};

/// Collapses edges of triangles with small angles on to one of their ends, or flips them, where the surface stays what it is:
/// manifold, with the same holes, borders and sharp lines, its triangles facing as before, and within tolerance. Points keep
/// their places.
///
/// returns: how many edges; points that are no longer used are kept
std::size_t mend_slivers(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, SharpLines lines,
                         const MendSlack& slack, std::vector<std::array<Index, 3>>& triangles);

/// How far the limit is from the middle of an edge, by the normals at its ends: exact for circles.
[[nodiscard]] inline double bend(const Vec3& a, const Vec3& b, const Vec3& normal_a, const Vec3& normal_b) {
    return std::abs(glm::dot(b - a, normal_b - normal_a)) / 8;
}

/// How far a point is from the line through two others.
[[nodiscard]] inline double distance_to_line(const Vec3& p, const Vec3& a, const Vec3& b) {
    const double length = glm::distance(a, b);
    return length > 0 ? glm::length(glm::cross(p - a, b - a)) / length : glm::distance(p, a);
}

/// Leaves the triangles of a boundary that lie on some sides of cells, and their points, and measures the surface anew.
///
/// mesh: that the places are in
void keep_sides(LimitSurface& surface, const HexMesh& mesh, std::span<const CellSide> sides);

}  // namespace subvol::detail
