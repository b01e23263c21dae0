#pragma once

#include <optional>
#include <vector>

#include "fill_block.h"
#include "subvol/dense_cells.h"
#include "subvol/refine.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// From the world to voxels, whose centres have whole numbers: (linear · x + offset) / voxel_size.
struct ToVoxels {
    Mat3 linear{1.0};
    Vec3 offset{0.0};
    double voxel_size = 1;

    [[nodiscard]] Vec3 operator()(const Vec3& x) const { return (linear * x + offset) / voxel_size; }
};

/// fields:   of the mesh; their channels become those of the voxels, one after the other
/// refine:   levels 0: the mesh as it is, unless on_limit
/// on_limit: the refined vertices are moved to the limit
struct RasterizeCells {
    const HexMesh* mesh = nullptr;
    std::vector<const Attribute*> fields;
    ToVoxels to_voxels;
    RefineOptions refine{.levels = 0};
    bool on_limit = false;
    bool cell_numbers = false;
    Progress* progress = nullptr;
};

/// Rasterizes the cells of a mesh into bricks of voxels, as often as wanted: for one part of space after the other.
///
/// A batch of cells at a time, in the order of their numbers: refined in parallel, then filled in parallel, a brick a task, so
/// that the first cell that holds a centre counts, whatever the number of threads. Memory: the voxels, and some 10 MB; where
/// the mesh is refined, a copy of it, and some 150 MB.
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
    void load_refined(Batch& batch) const;
    void fill(const Batch& batch, const std::optional<VoxelBox>& part, VoxelBricks& bricks);
    [[nodiscard]] std::vector<Index> cells_of(const std::optional<VoxelBox>& part) const;
    [[nodiscard]] CellBlock block(const Batch& batch, std::size_t i) const;
    [[nodiscard]] bool refines() const { return request_.refine.levels > 0 || request_.on_limit; }

    RasterizeCells request_;
    FillOptions fill_;
    std::optional<DenseCells> refined_;
    std::size_t side_ = 2;         // nodes of a block
    std::vector<VoxelBox> boxes_;  // of every cell, after the first run
};

}  // namespace subvol::detail
