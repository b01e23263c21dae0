// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fill_block.h"
#include "refined_cells.h"
#include "surface_columns.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// Rasterizes the cells of a mesh into bricks of voxels, as often as wanted: for one part of space after the other.
///
/// A batch of cells at a time, in the order of their numbers: refined in parallel, then filled in parallel, a brick a task, so
/// that the first cell that holds a centre counts, whatever the number of threads. Where cells are folded, voxels that the
/// mesh's boundary does not go round are taken out again. Memory: the voxels, and some 10 MB; where the mesh is refined, a copy
/// of it, and some 150 MB.
class CellRasterizer {
public:
    /// The mesh must be valid; it is kept by reference.
    ///
    /// throws: Error(InvalidInput) if the voxels are too small: 2³⁰ from the origin, or too many; says what would be right
    explicit CellRasterizer(RasterizeCells request);

    /// part: only these voxels; whole bricks. none: all
    [[nodiscard]] VoxelBricks run(const std::optional<VoxelBox>& part = {});

private:
    struct Batch;
    void load(std::span<const Index> cells, Batch& batch);
    void load_cells(Batch& batch) const;
    void load_refined(Batch& batch) const;
    void fill(const Batch& batch, const std::optional<VoxelBox>& part, VoxelBricks& bricks);
    void drop_leaks();
    [[nodiscard]] std::vector<Index> cells_of(const std::optional<VoxelBox>& part) const;
    [[nodiscard]] std::size_t side(Index cell) const { return (std::size_t{1} << request_.levels(cell)) + 1; }
    [[nodiscard]] CellBlock block(const Batch& batch, std::size_t i) const;
    [[nodiscard]] bool refines() const { return request_.refines(); }

    RasterizeCells request_;
    RefinedCells refined_;
    FillOptions fill_;
    std::vector<VoxelBox> boxes_;            // of every cell, after the first run
    std::vector<VoxelBrick*> doubtful_;      // of this run
    std::optional<SurfaceColumns> columns_;  // of the boundary, once a brick was doubtful
};

}  // namespace subvol::detail
