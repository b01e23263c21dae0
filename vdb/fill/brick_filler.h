// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "cell_request.h"
#include "fill_block.h"
#include "refined_grids.h"
#include "surface_columns.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// Fills bricks of voxels from the cells of a mesh; it can be run several times, for one part of space after the other.
///
/// Cells, or pieces of cells, are blocks. They are taken in batches, in the order of their numbers: each batch is refined in
/// parallel, then filled in parallel with one task per brick. So the first cell that contains a voxel centre determines its
/// value, for any number of threads. Where cells are folded, voxels outside the mesh's boundary (winding number 0) are removed
/// again. Memory: the voxels, and some 10 MB; where the mesh is refined, a copy of it, and some 150 MB.
class BrickFiller {
public:
    /// The mesh must be valid; it is kept by reference.
    ///
    /// throws: Error(InvalidInput) if a voxel would lie 2³⁰ voxels from the origin or there would be too many of them; the
    ///         message names a voxel size that is large enough
    explicit BrickFiller(CellRequest request);

    /// part: only these voxels, whole bricks; none: all voxels
    [[nodiscard]] VoxelBricks run(const std::optional<VoxelBox>& part = {});

    /// Whether cells of the last run fold over.
    [[nodiscard]] bool folded() const { return folded_; }

private:
    struct Batch;
    void load(std::span<const Index> blocks, Batch& batch);
    void load_cells(Batch& batch) const;
    void load_refined(Batch& batch) const;
    void load_pieces(Batch& batch) const;
    [[nodiscard]] std::uint8_t boundary_of(Index block) const;
    void fill(const Batch& batch, const std::optional<VoxelBox>& part, VoxelBricks& bricks);
    void drop_leaks(std::size_t leaf_channels);
    [[nodiscard]] SurfaceColumns columns_through(std::span<VoxelBrick* const> bricks) const;
    [[nodiscard]] std::vector<Index> blocks_in(const std::optional<VoxelBox>& part) const;
    [[nodiscard]] CellBlock block(const Batch& batch, std::size_t i) const;
    [[nodiscard]] bool refines() const { return request_.refines(); }

    CellRequest request_;
    RefinedGrids refined_;
    std::size_t channels_ = 0;            // of all fields
    double orientation_ = 1;              // -1 for a mesh of left-handed cells
    std::vector<std::uint8_t> boundary_;  // of curved cells: which sides
    std::vector<VoxelBox> boxes_;         // of every block, after the first run
    bool folded_ = false;
    std::vector<VoxelBrick*> doubtful_;  // of this run
};

}  // namespace subvol::detail
