// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/limit_level.h"
#include "subvol/progress.h"
#include "subvol/refine.h"

namespace subvol::detail {

/// From world space to voxel space, where voxel centres have whole coordinates: (linear · x + offset) / voxel_size.
struct ToVoxels {
    Mat3 linear{1.0};
    Vec3 offset{0.0};
    double voxel_size = 1;

    [[nodiscard]] Vec3 operator()(const Vec3& x) const { return (linear * x + offset) / voxel_size; }
};

/// Cells to be rasterized: a mesh, how it is refined, and the voxels.
struct CellRequest {
    const HexMesh* mesh = nullptr;
    /// Fields of the mesh; their channels become those of the voxels, one after the other.
    std::vector<const Attribute*> fields;
    ToVoxels to_voxels;
    RefineOptions refine{.levels = 0};  ///< levels 0: the mesh itself, unless on_limit or curved
    bool on_limit = false;              ///< the refined vertices are moved to the limit
    bool curved = false;                ///< positions and values are triquadratic between the vertices of the next level
    double slack_voxels = 0;            ///< for curved cells: how much two neighbours' ideas of their shared side may differ
    /// Null, or for each control cell the level of its vertices, which replaces the next one; at least 1.
    const std::vector<std::uint8_t>* cell_levels = nullptr;
    /// Null, or the curved cells' pieces, with the values of the fields: then nothing is refined, and `cell_levels` is unused.
    const LimitPieces* pieces = nullptr;
    std::vector<std::size_t> places_in_pieces{};  ///< for each field its place in the pieces
    /// Null, or how fine the pieces are that are looked for while the voxels are filled; `pieces` is null then.
    const LimitCellsOptions* search = nullptr;
    /// Null, or tables that do to this mesh what `refine` (with one more level if curved) and `on_limit` do.
    const RefinementTables* tables = nullptr;
    bool cell_numbers = false;
    /// The numbers that voxels get for the cells; kNone: the cell is not filled, and only shapes the limit of the others.
    /// Empty: all cells, by their places.
    std::span<const Index> numbers{};
    Progress* progress = nullptr;

    /// Whether a cell is filled. cell: kNone: none
    [[nodiscard]] bool fills(Index cell) const { return cell != kNone && (numbers.empty() || numbers[cell] != kNone); }
    /// Whether a face is one where what is filled ends.
    [[nodiscard]] bool ends_at(const std::array<Index, 2>& face_cells) const {
        return fills(face_cells[0]) != fills(face_cells[1]);
    }
    [[nodiscard]] Index number_of(Index cell) const { return numbers.empty() ? cell : numbers[cell]; }

    [[nodiscard]] bool refines() const { return refine.levels > 0 || on_limit || curved; }

    /// How many blocks there are to be filled: cells or pieces.
    [[nodiscard]] std::size_t block_count() const { return pieces ? pieces->cells.size() : mesh->cells.size(); }
    /// The cell of a block.
    [[nodiscard]] Index cell_of(Index block) const { return pieces ? pieces->cells[block] : block; }

    /// The level of the vertices that a cell is made of.
    [[nodiscard]] int levels() const { return refine.levels + (curved ? 1 : 0); }
    [[nodiscard]] int levels(Index cell) const { return cell_levels ? (*cell_levels)[cell] : levels(); }
    /// Vertices along each axis of a block.
    [[nodiscard]] std::size_t side(Index block) const { return pieces ? 3 : (std::size_t{1} << levels(block)) + 1; }
};

}  // namespace subvol::detail
