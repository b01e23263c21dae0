// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// A mesh with layers of cells that another one has not, and in which cell of that one each of its cells lies.
struct LayeredMesh {
    HexMesh mesh;
    std::vector<Index> from;
};

/// Where layers lie: inside of each part of a mesh along the faces that part it from other cells.
struct Layers {
    std::span<const Index> parts;  ///< a number for each cell; cells of kNone stay as they are
    bool at_hull = false;          ///< layers also lie along the hull
    /// Layers also lie along the faces between cells of one material at these edges
    std::span<const std::array<Index, 2>> cuts{};
    std::span<const Index> materials{};  ///< as of `wall_of`
    double inwards;  ///< how far the cells of a part move away for a layer: a part of the way to the middles of the cells
};

/// The mesh with layers. Its cells and points keep their numbers, and the new ones follow; points keep their places, too, at
/// the outer side of a layer.
[[nodiscard]] LayeredMesh with_layers(const HexMesh& mesh, const Layers& layers);

/// A layer inside of all walls of each material.
///
/// materials: as of `wall_of`
[[nodiscard]] LayeredMesh with_layer_at_walls(const HexMesh& mesh, std::span<const Index> materials = {});

/// A layer under the cells at walls, and on both sides of given edges of walls, so that paths of them may turn at every point.
///
/// along:     edges of walls, two points each
/// materials: as of `wall_of`
[[nodiscard]] LayeredMesh with_layer_along(const HexMesh& mesh, std::span<const std::array<Index, 2>> along,
                                           std::span<const Index> materials = {});

}  // namespace subvol::detail
