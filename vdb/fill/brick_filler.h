// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "cell_request.h"
#include "fill_block.h"
#include "refined_grids.h"
#include "subvol/detail/flat_array.h"
#include "surface_columns.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// Fills bricks of voxels from the cells of a mesh; it can be run several times, for one part of space after the other.
///
/// Cells, or pieces of cells, are blocks. They are taken in batches, in the order of their numbers: each batch is refined in
/// parallel, then filled in parallel with one task per brick. So the first cell that contains a voxel centre determines its
/// value, for any number of threads. Pieces that are looked for (`CellRequest::search`) are filled as they are found, so that
/// there are never all of them. Where cells are folded, voxels outside the mesh's boundary (winding number 0) are removed
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

    /// How fine the pieces were that the run has looked for; a filler that looks for pieces runs once.
    [[nodiscard]] LimitCells& found() { return found_; }

    /// Whether cells of the last run fold over.
    [[nodiscard]] bool folded() const { return folded_; }

private:
    /// Some blocks, one after the other: cells, or pieces of cells.
    struct Batch {
        std::span<const Index> numbers;  ///< the numbers of the blocks
        std::vector<std::size_t> first;  ///< the first node of each block, then the number of all nodes
        FlatArray<Vec3> points;
        FlatArray<double> values;
        FlatArray<Index> ids;                  ///< the ids of the nodes of unrefined cells
        std::vector<VoxelBox> boxes;           ///< the voxels of each block
        std::vector<std::size_t> first_piece;  ///< the first piece of each curved cell, in `piece_boxes`
        std::vector<VoxelBox> piece_boxes;
    };
    void load(std::span<const Index> blocks, Batch& batch);
    void load_cells(Batch& batch) const;
    void load_refined(Batch& batch) const;
    void load_pieces(Batch& batch) const;
    void set_boxes(Batch& batch) const;
    [[nodiscard]] std::uint8_t boundary_of(Index block) const;
    [[nodiscard]] bool touches_cut(Index block) const;
    [[nodiscard]] bool is_filled(Index block) const;
    /// Whether voxels have the numbers of cells, at least until `drop_others`.
    [[nodiscard]] bool has_numbers() const { return request_.cell_numbers || !cut_.empty(); }
    void fill_found(const std::optional<VoxelBox>& part, VoxelBricks& bricks);
    std::vector<VoxelBox> fill_blocks(std::span<const Index> blocks, const std::optional<VoxelBox>& part, VoxelBricks& bricks);
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
    std::vector<std::uint8_t> boundary_;  // of curved cells without pieces: which sides
    std::vector<std::uint8_t> cut_;      // of curved cells, some of which are filled: the sides where that ends inside the mesh
    std::vector<VoxelBox> boxes_;        // of every block, after the first run; of found pieces, those on the hull
    std::vector<Index> cells_of_boxes_;  // of found pieces
    LimitCells found_;
    Batch batch_;  // its memory serves one batch after the other
    bool folded_ = false;
    std::vector<VoxelBrick*> doubtful_;  // of this run
};

}  // namespace subvol::detail
