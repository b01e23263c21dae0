// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "subvol/dense_cells.h"
#include "subvol/limit_level.h"
#include "subvol/refine.h"

namespace subvol::detail {

/// From the world to voxels, whose centres have whole numbers: (linear · x + offset) / voxel_size.
struct ToVoxels {
    Mat3 linear{1.0};
    Vec3 offset{0.0};
    double voxel_size = 1;

    [[nodiscard]] Vec3 operator()(const Vec3& x) const { return (linear * x + offset) / voxel_size; }
};

/// fields:      of the mesh; their channels become those of the voxels, one after the other
/// refine:      levels 0: the mesh as it is, unless on_limit or curved
/// on_limit:    the refined vertices are moved to the limit
/// curved:      places and values are triquadratic between the vertices of the next level, which still bounds the volume
/// cell_levels: null, or for each control cell the level of the vertices to take instead of the next one; not below
///              refine.levels, nor below 1
/// tables:      null, or what `refine`, with the next level if curved, and `on_limit` do to this mesh
struct RasterizeCells {
    const HexMesh* mesh = nullptr;
    std::vector<const Attribute*> fields;
    ToVoxels to_voxels;
    RefineOptions refine{.levels = 0};
    bool on_limit = false;
    bool curved = false;
    const std::vector<std::uint8_t>* cell_levels = nullptr;
    const RefinementTables* tables = nullptr;
    bool cell_numbers = false;
    Progress* progress = nullptr;

    [[nodiscard]] bool refines() const { return refine.levels > 0 || on_limit || curved; }

    /// The level of the vertices that a cell is made of.
    [[nodiscard]] int levels() const { return refine.levels + (curved ? 1 : 0); }
    [[nodiscard]] int levels(Index cell) const { return cell_levels ? (*cell_levels)[cell] : levels(); }
};

/// Curved cells that stand for the limit. From tables all have nodes of one level.
///
/// throws: Error(InvalidInput) if they are of another mesh
void set_limit(const LimitCells& limit, RasterizeCells& request);

/// Tables that do what `refine` does, and then `on_limit`.
[[nodiscard]] RefinementTables tables_of(const HexMesh& mesh, const RefineOptions& refine, bool on_limit);

/// The refined grids of a mesh's cells with the fields asked for: cell by cell as `for_each_dense_cell`, or from tables, which
/// give the same.
class RefinedCells {
public:
    /// throws: Error(InvalidInput) if the tables belong to another mesh or another level
    explicit RefinedCells(const RasterizeCells& request);

    /// levels: of the grids; from tables there is one only. visit: is called from several threads at once and in no order; the
    /// spans are gone after the call
    void for_each(std::span<const Index> cells, int levels, const std::function<void(const DenseCell&)>& visit) const;

private:
    void refine_whole(const RefinementTables& tables);
    void gather(Index cell, DenseCell& dense, std::vector<Vec3>& points, std::vector<std::vector<double>>& values) const;

    int levels_;                       // from tables
    std::optional<DenseCells> dense_;  // without tables
    const RefinementTables* tables_;
    HexMesh mesh_;  // from tables: refined, with nothing but the fields, without its cells
    /// Of each node of a grid: a cell among the descendants of the control cell, and its corner.
    struct Node {
        std::size_t cell, corner;
    };
    std::vector<Node> nodes_;
};

}  // namespace subvol::detail
