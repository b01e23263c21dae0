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
struct MeshSubset {
    HexMesh mesh;
    std::vector<Index> points, cells;  ///< their numbers in the mesh, ascending
};
[[nodiscard]] MeshSubset subset(const HexMesh& mesh, std::span<const std::uint8_t> cells);

/// The values in some cells of a mesh, by their numbers. cells: as of an attribute, or empty
[[nodiscard]] std::vector<double> of_cells(std::span<const double> cells, int channels, std::span<const Index> numbers);

/// What is known at the points of a mesh that others keep. places: of each point its number among these, or kNone
[[nodiscard]] GradientsAtPoints at_kept_points(const GradientsAtPoints& gradients, int channels, std::span<const Index> places);

/// Whether a field has a value for each cell of the mesh, and whether it is constant there, too.
[[nodiscard]] bool is_at_cells(const HexMesh& mesh, const Attribute& field);
[[nodiscard]] bool is_constant_in_cells(const HexMesh& mesh, const Attribute& field);

/// Sets the values at points of a field at cells to the means over the cells at each point. Points of no cell keep theirs.
void set_means_at_points(const HexMesh& mesh, Attribute& field);

/// Leaves out tags whose edges and faces are not of the mesh's cells.
void keep_own_tags(HexMesh& mesh);

}  // namespace subvol::detail
