// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/surface.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The material that a face is a wall of: the lower of those of its cells where they differ, that of its cell on the hull;
/// kNone inside of a material.
///
/// materials: of each cell; none: there is one, 0
[[nodiscard]] inline Index wall_of(const Topology& topology, std::span<const Index> materials, Index face) {
    const auto [a, b] = topology.face_cells[face];
    const auto material = [&](Index cell) { return materials.empty() ? Index{0} : materials[cell]; };
    if (b == kNone) return material(a);
    return material(a) == material(b) ? kNone : std::min(material(a), material(b));
}

/// The faces between materials become sharp, so that each material has a limit of its own, up to the wall.
void sharpen_walls(HexMesh& mesh, std::span<const Index> materials);

/// What the walls of a material are drawn to.
struct WallTarget {
    const Surface* surface;
    /// Whether the material's walls are to reach a place of the surface; none: all of them
    ///
    /// normal: of the surface there, a unit vector
    std::function<bool(const Vec3& place, const Vec3& normal)> reaches = {};

    [[nodiscard]] bool reached(const Vec3& place, const Vec3& normal) const { return !reaches || reaches(place, normal); }
};

}  // namespace subvol::detail
