// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "subvol/detail/all_cells.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/part_of_progress.h"
#include "subvol/error.h"
#include "subvol/join_grids.h"
#include "voxel_blocks.h"

// A mesh in pieces is rasterized in blocks of voxels. The space of voxels, in cubes of 32³, is halved along its longest side
// until what a block takes fits into the memory:
//
//      +-----------+-----+-----+      bytes(block) = 1600 · cells about it + 10 · channels · its voxels,
//      |           |  b  |  c  |
//      |     a     +-----+-----+      where the cells of a piece are taken to lie evenly in the box of its limit. The cells
//      |           |  d  |  e  |      whose limit may touch a block are gathered from the pieces, and only they are rasterized.
//      +-----------+-----+-----+
//
// A share is a slab of whole layers of cubes across x.

namespace subvol::detail {

namespace {

// The memory of a cell that is gathered: the cell twice, its topology, and the pieces of its limit, which are sorted once.
constexpr double kBytesOfCell = 1600;
constexpr double kBytesOfBrickChannel = 10;  // of a voxel: leaves that are not full, and the grid that is made of them

constexpr double kMostIndex = 1 << 30;  // as of the voxels of a mesh
constexpr std::size_t kMostBlocks = 1'000'000;

[[noreturn]] void fail_too_fine(double voxel, const std::string& why, double right) {
    throw Error(ErrorCode::InvalidInput, why, "voxel size " + detail::number_text(voxel),
                "at least " + detail::number_text(right) + " would be right");
}

/// Cuts a share of the space of voxels into blocks whose cells and voxels fit into the memory.
class BlockPlan {
public:
    BlockPlan(const MeshSource::Stored& stored, double voxel, double memory, const Share& share = {})
        : stored_(stored), memory_(memory), voxel_(voxel) {
        if (!(voxel > 0)) throw Error(ErrorCode::InvalidInput, "blocks of voxels need a voxel size");
        for (const SourceField& field : stored.fields) channels_ += field.channels;
        Box reach;
        for (const PieceExtent& piece : stored.pieces) reach.add(piece.reach);
        const Vec3 far = glm::max(glm::abs(reach.lower), glm::abs(reach.upper)) / voxel_;
        if (const double farthest = std::max({far.x, far.y, far.z}); !(farthest < kMostIndex)) {
            fail_too_fine(voxel_, "voxel numbers count from the world's origin and would not fit 32 bits",
                          1.01 * voxel_ * farthest / kMostIndex);
        }
        VoxelCubes all;
        for (int d = 0; d < 3; ++d) {
            const auto cube = [&](double x) { return static_cast<int>(std::floor(x / voxel_ / VoxelCubes::kSide)); };
            all.lower[static_cast<std::size_t>(d)] = cube(reach.lower[d] - voxel_);
            all.upper[static_cast<std::size_t>(d)] = cube(reach.upper[d] + voxel_) + 1;
        }
        const double blocks = bytes_of(all) / memory_;
        if (!(blocks <= kMostBlocks)) {
            fail_too_fine(voxel_, "the mesh would be made in more than a million blocks of voxels",
                          1.01 * voxel_ * std::cbrt(blocks / kMostBlocks));
        }
        layers_.end = layers_.count = static_cast<std::uint64_t>(all.upper[0] - all.lower[0]);
        if (!share.whole()) all = slab_of(all, share);
        if (all.lower[0] < all.upper[0]) cut(all);
    }

    [[nodiscard]] const std::vector<VoxelCubes>& blocks() const { return blocks_; }
    /// The layers across x of the share.
    [[nodiscard]] const ShareRange& layers() const { return layers_; }

    /// The box of a block and a voxel more. whole_columns: all that is above and below it too
    [[nodiscard]] Box box_of(const VoxelCubes& block, bool whole_columns = false) const {
        Box box;
        for (int d = 0; d < 3; ++d) {
            const auto axis = static_cast<std::size_t>(d);
            box.lower[d] = (VoxelCubes::kSide * static_cast<double>(block.lower[axis]) - 1) * voxel_;
            box.upper[d] = VoxelCubes::kSide * static_cast<double>(block.upper[axis]) * voxel_;
        }
        if (whole_columns) {
            box.lower.z = -std::numeric_limits<double>::infinity();
            box.upper.z = std::numeric_limits<double>::infinity();
        }
        return box;
    }

private:
    /// The layers across x of a share.
    [[nodiscard]] VoxelCubes slab_of(const VoxelCubes& all, const Share& share) {
        std::vector<double> bytes;
        for (int layer = all.lower[0]; layer < all.upper[0]; ++layer) {
            VoxelCubes one = all;
            one.lower[0] = layer;
            one.upper[0] = layer + 1;
            bytes.push_back(bytes_of(one));
        }
        const auto [begin, end] = share.range_by_weight(bytes);
        layers_ = {begin, end, bytes.size()};
        VoxelCubes slab = all;
        slab.lower[0] = all.lower[0] + static_cast<int>(begin);
        slab.upper[0] = all.lower[0] + static_cast<int>(end);
        return slab;
    }

    /// Cells in a block, if each piece's are spread evenly over its box.
    [[nodiscard]] double bytes_of(const VoxelCubes& block) const {
        const Box box = box_of(block);
        double bytes = 0;
        for (const PieceExtent& piece : stored_.pieces) {
            double share = 1, voxels = 1;
            for (int d = 0; d < 3; ++d) {
                // The halo and the cells that reach into the block, in cells of the piece's mean width.
                const double size = piece.reach.upper[d] - piece.reach.lower[d];
                const double cell = size / std::cbrt(static_cast<double>(std::max<std::uint64_t>(piece.cells, 1)));
                const double more = (stored_.halo_layers + 1) * cell;
                const double low = std::max(box.lower[d] - more, piece.reach.lower[d]);
                const double high = std::min(box.upper[d] + more, piece.reach.upper[d]);
                if (!(low <= high)) share = 0;
                if (size > 0) share *= std::max(0.0, high - low) / size;
                voxels *= std::max(0.0, std::min(box.upper[d], piece.bounds.upper[d]) -
                                            std::max(box.lower[d], piece.bounds.lower[d])) /
                          voxel_;
            }
            bytes += share * static_cast<double>(piece.cells) * kBytesOfCell + voxels * kBytesOfBrickChannel * channels_;
        }
        return bytes;
    }

    void cut(const VoxelCubes& block) {
        const double bytes = bytes_of(block);
        if (bytes == 0) return;
        std::size_t longest = 0;
        const auto side = [&](std::size_t d) { return block.upper[d] - block.lower[d]; };
        for (std::size_t d = 1; d < 3; ++d) longest = side(d) > side(longest) ? d : longest;
        if (bytes <= memory_ || side(longest) == 1) {
            if (blocks_.size() == kMostBlocks) {
                throw Error(ErrorCode::InvalidInput, "the mesh would be made in more than a million blocks of voxels",
                            "--memory " + detail::number_text(memory_), "more memory, or larger voxels");
            }
            blocks_.push_back(block);
            return;
        }
        VoxelCubes low = block, high = block;
        low.upper[longest] = high.lower[longest] = block.lower[longest] + side(longest) / 2;
        cut(low);
        cut(high);
    }

    const MeshSource::Stored& stored_;
    double memory_, voxel_, channels_ = 0;
    std::vector<VoxelCubes> blocks_;
    ShareRange layers_{};
};

/// What a block of voxels is made of.
class BlockMaker {
public:
    BlockMaker(const MeshSource& source, std::span<const std::string> fields, const RasterizeOptions& options)
        : source_(source), fields_(fields), options_(options) {
        for (const SourceField& field : source.stored().fields) ranges_.push_back({field.min, field.max});
    }

    [[nodiscard]] BlockGrids make(const VoxelCubes& block, const Box& box, Progress* progress) {
        const MeshPiece part = gather(source_, box);
        if (part.mesh.cells.empty()) return {};
        RasterizeOptions options = options_;
        options.frame = source_.bounds();
        options.progress = options.refine.progress = progress;
        LimitCells limit;
        if (options.find_limit) {
            limit = find_limit_cells(part.mesh, all_cells(part.mesh), options.refine,
                                     {.position_world = kLimitTolerance_voxels * options.voxel_size_world,
                                      .max_bytes = std::numeric_limits<std::size_t>::max()},
                                     ranges_);
            options.limit = &limit;
            converged_ = converged_ && limit.converged;
        }
        return rasterize_block(part.mesh, fields_, options, block);
    }

    [[nodiscard]] bool converged() const { return converged_; }

private:
    const MeshSource& source_;
    std::span<const std::string> fields_;
    const RasterizeOptions& options_;
    std::vector<std::array<double, 2>> ranges_;
    bool converged_ = true;
};

/// Makes the blocks of a plan one after the other.
///
/// take: gets the grids of each that has some
template <class Take>
PartsReport make_blocks(const BlockPlan& plan, BlockMaker maker, Progress* progress, const Take& take) {
    PartsReport report{.blocks = plan.blocks().size()};
    for (std::size_t b = 0; b < plan.blocks().size(); ++b) {
        PartOfProgress block_progress(progress, "rasterize", b, plan.blocks().size());
        report_progress(&block_progress, "rasterize", 0);
        const VoxelCubes& block = plan.blocks()[b];
        BlockGrids made = maker.make(block, plan.box_of(block), &block_progress);
        if (made.folded) {
            ++report.folded;
            made = maker.make(block, plan.box_of(block, true), &block_progress);
        }
        if (!made.grids.empty()) take(std::move(made.grids));
    }
    report.converged = maker.converged();
    return report;
}

/// The grids of no voxels.
std::vector<VdbGrid> empty_grids(const MeshSource& source, std::span<const std::string> fields, RasterizeOptions options) {
    HexMesh cell;
    for (int k = 0; k < 8; ++k) cell.points.emplace_back(k & 1, k >> 1 & 1, k >> 2 & 1);
    cell.cells.push_back({0, 1, 3, 2, 4, 5, 7, 6});
    for (const SourceField& field : source.stored().fields) {
        const std::size_t values = 8 * static_cast<std::size_t>(field.channels);
        cell.attributes.push_back({field.name, field.channels, std::vector<double>(values)});
    }
    options.frame = source.bounds();
    options.refine = {.levels = 0};
    options.on_limit = false;
    return rasterize_block(cell, fields, options, {{1, 1, 1}, {1, 1, 1}}).grids;
}

}  // namespace

PartsReport rasterize_blocks(const MeshSource& source, std::span<const std::string> fields, const RasterizeOptions& options,
                             double memory_bytes, const std::function<void(GridPart)>& take) {
    const BlockPlan plan(source.stored(), options.voxel_size_world, memory_bytes);
    GridPart part{0, static_cast<int>(plan.blocks().size()), {}};
    return make_blocks(plan, {source, fields, options}, options.progress, [&](std::vector<VdbGrid> grids) {
        const bool filled = std::ranges::any_of(grids, [](const VdbGrid& grid) { return grid.report().active_voxels > 0; });
        if (!filled) return;
        take({part.number, part.of, std::move(grids)});
        ++part.number;
    });
}

GridShare rasterize_share_of_pieces(const MeshSource& source, std::span<const std::string> fields,
                                    const RasterizeOptions& options, const Share& share) {
    const BlockPlan plan(source.stored(), options.voxel_size_world, static_cast<double>(options.block_bytes), share);
    std::vector<std::vector<VdbGrid>> blocks;  // of each grid
    for (VdbGrid& grid : empty_grids(source, fields, options)) blocks.emplace_back().push_back(std::move(grid));
    GridShare made{.grids = {}, .layers = plan.layers()};
    made.report = make_blocks(plan, {source, fields, options}, options.progress, [&](std::vector<VdbGrid> block) {
        for (std::size_t g = 0; g < block.size(); ++g) blocks.at(g).push_back(std::move(block[g]));
    });
    for (std::vector<VdbGrid>& grids : blocks) made.grids.push_back(join_grids(std::move(grids)));
    return made;
}

}  // namespace subvol::detail
