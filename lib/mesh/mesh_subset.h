// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// A flag for each point: whether a cell uses it.
[[nodiscard]] std::vector<std::uint8_t> used_points(const HexMesh& mesh);

/// Adds layers of cells: each has all cells that share a point with a cell before. cells: a flag for each cell of the mesh
void grow(const HexMesh& mesh, std::vector<std::uint8_t>& cells, int layers);

/// Some cells of a mesh with their points, and the tags that belong to them.
///
/// points, cells: their numbers in the mesh, ascending
struct MeshSubset {
    HexMesh mesh;
    std::vector<Index> points, cells;
};
[[nodiscard]] MeshSubset subset(const HexMesh& mesh, std::span<const std::uint8_t> cells);

/// Leaves out tags whose edges and faces are not of the mesh's cells.
void keep_own_tags(HexMesh& mesh);

}  // namespace subvol::detail
