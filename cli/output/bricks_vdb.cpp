// SPDX-License-Identifier: Apache-2.0
#include "bricks_vdb.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "grid_fields.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/part_of_progress.h"
#include "subvol/join_grids.h"
#include "subvol/rasterize_block.h"
#include "text.h"
#include "vdb_parts.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

constexpr std::uint64_t kDefaultMemory = std::uint64_t{1} << 30;
// Of a cell that is gathered: itself twice, its topology, and the pieces of its limit, which are sorted once.
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
    BlockPlan(const BricksToVoxels& what, double memory, const Share& share) : bricks_(what.bricks), memory_(memory) {
        voxel_ = what.options.voxel_size_world;
        for (const StreamedField& field : what.fields) channels_ += field.vector ? 3 : 1;
        Box reach;
        for (const Brick& brick : bricks_.bricks) reach.add(brick.reach);
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
        if (!share.whole()) all = slab_of(all, share);
        if (all.lower[0] < all.upper[0]) cut(all);
    }

    [[nodiscard]] const std::vector<VoxelCubes>& blocks() const { return blocks_; }

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
    /// The layers of a share; none if there are more shares than layers.
    [[nodiscard]] VoxelCubes slab_of(const VoxelCubes& all, const Share& share) const {
        std::vector<double> bytes;
        for (int layer = all.lower[0]; layer < all.upper[0]; ++layer) {
            VoxelCubes one = all;
            one.lower[0] = layer;
            one.upper[0] = layer + 1;
            bytes.push_back(bytes_of(one));
        }
        const auto [begin, end] = share.range_by_weight(bytes);
        VoxelCubes slab = all;
        slab.lower[0] = all.lower[0] + static_cast<int>(begin);
        slab.upper[0] = all.lower[0] + static_cast<int>(end);
        return slab;
    }

    /// Cells in a block, if each brick's are spread evenly over its box.
    [[nodiscard]] double bytes_of(const VoxelCubes& block) const {
        const Box box = box_of(block);
        double bytes = 0;
        for (const Brick& brick : bricks_.bricks) {
            double share = 1, voxels = 1;
            for (int d = 0; d < 3; ++d) {
                // The halo and the cells that reach into the block, in cells of the brick's mean width.
                const double size = brick.reach.upper[d] - brick.reach.lower[d];
                const double cell = size / std::cbrt(static_cast<double>(std::max<std::uint64_t>(brick.cells, 1)));
                const double more = (bricks_.halo_layers + 1) * cell;
                const double low = std::max(box.lower[d] - more, brick.reach.lower[d]);
                const double high = std::min(box.upper[d] + more, brick.reach.upper[d]);
                if (!(low <= high)) share = 0;
                if (size > 0) share *= std::max(0.0, high - low) / size;
                voxels *= std::max(0.0, std::min(box.upper[d], brick.bounds.upper[d]) -
                                            std::max(box.lower[d], brick.bounds.lower[d])) /
                          voxel_;
            }
            bytes += share * static_cast<double>(brick.cells) * kBytesOfCell + voxels * kBytesOfBrickChannel * channels_;
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

    const Bricks& bricks_;
    double memory_, voxel_ = 1, channels_ = 0;
    std::vector<VoxelCubes> blocks_;
};

/// What a block of voxels is made of.
class BlockMaker {
public:
    explicit BlockMaker(const BricksToVoxels& what) : what_(what) {
        for (const StreamedField& field : what.fields) ranges_.push_back({field.min, field.max});
    }

    [[nodiscard]] BlockGrids make(const VoxelCubes& block, const Box& box) {
        const BrickMesh part = gather(what_.bricks, box);
        if (part.mesh.cells.empty()) return {};
        const HexMesh mesh = with_brick_fields(part.mesh, what_.fields);
        RasterizeOptions options = what_.options;
        LimitCells limit;
        if (what_.limit) {
            limit = detail::find_limit_cells(mesh, options.refine,
                                             {.position_world = kLimitTolerance_voxels * options.voxel_size_world,
                                              .max_bytes = std::numeric_limits<std::size_t>::max()},
                                             ranges_);
            options.limit = &limit;
            converged_ = converged_ && limit.converged;
        }
        return vdb().rasterize_block(mesh, names_of(mesh), options, block);
    }

    [[nodiscard]] bool converged() const { return converged_; }

private:
    const BricksToVoxels& what_;
    std::vector<std::array<double, 2>> ranges_;
    bool converged_ = true;
};

/// The grids of one name in all blocks.
struct GridSum {
    std::string name, kind;
    std::uint64_t active_voxels = 0, bytes = 0;
    double min, max;
};

void add(std::vector<GridSum>& sums, const std::vector<VdbGrid>& grids) {
    for (std::size_t g = 0; g < grids.size(); ++g) {
        const GridReport& grid = grids[g].report();
        if (sums.size() <= g) sums.push_back({.name = grid.name, .kind = grid.kind, .min = grid.min, .max = grid.max});
        GridSum& sum = sums[g];
        sum.active_voxels += grid.active_voxels;
        sum.bytes += grid.bytes;
        sum.min = std::min(sum.min, static_cast<double>(grid.min));
        sum.max = std::max(sum.max, static_cast<double>(grid.max));
    }
}

FactValue::List list_of(const std::vector<GridSum>& sums) {
    FactValue::List list;
    for (const GridSum& sum : sums) {
        Facts entry;
        entry["name"] = sum.name;
        entry["kind"] = sum.kind;
        entry["active_voxels"] = sum.active_voxels;
        entry["min"] = sum.min;
        entry["max"] = sum.max;
        entry["bytes"] = sum.bytes;
        list.emplace_back(std::move(entry));
    }
    return list;
}

/// Makes the blocks of a plan one after the other.
///
/// take: gets the grids of each that has some
Facts make_blocks(const BricksToVoxels& what, const BlockPlan& plan, const std::function<void(std::vector<VdbGrid>)>& take) {
    Facts facts;
    BricksToVoxels blockwise = what;
    BlockMaker maker(blockwise);
    std::size_t folded = 0;
    for (std::size_t b = 0; b < plan.blocks().size(); ++b) {
        detail::PartOfProgress progress(what.options.progress, "rasterize", b, plan.blocks().size());
        blockwise.options.progress = blockwise.options.refine.progress = &progress;
        report_progress(&progress, "rasterize", 0);
        const VoxelCubes& block = plan.blocks()[b];
        BlockGrids made = facts.timed(&progress, "rasterize", [&] { return maker.make(block, plan.box_of(block)); });
        if (made.folded) {
            ++folded;
            made = facts.timed(&progress, "rasterize", [&] { return maker.make(block, plan.box_of(block, true)); });
        }
        if (!made.grids.empty()) take(std::move(made.grids));
    }
    if (!maker.converged()) facts.warn("the limit is coarser than its tolerance in some cells");
    if (folded > 0) facts.note(text("cells fold over in ", folded, " of ", plan.blocks().size(), " blocks of voxels"));
    return facts;
}

/// The grids of no voxels.
std::vector<VdbGrid> empty_grids(const BricksToVoxels& what) {
    const HexMesh mesh = with_brick_fields(stand_in(what.bricks), what.fields);
    RasterizeOptions options = what.options;
    options.refine = {.levels = 0};
    options.on_limit = false;
    return vdb().rasterize_block(mesh, names_of(mesh), options, {{1, 1, 1}, {1, 1, 1}}).grids;
}

}  // namespace

WithFacts<std::vector<VdbGrid>> grids_of_bricks(const BricksToVoxels& what, std::size_t memory_bytes, const Share& share) {
    const BlockPlan plan(what, static_cast<double>(memory_bytes > 0 ? memory_bytes : kDefaultMemory), share);
    std::vector<std::vector<VdbGrid>> of_grids;  // of each grid its blocks
    for (VdbGrid& grid : empty_grids(what)) of_grids.emplace_back().push_back(std::move(grid));
    Facts facts = make_blocks(what, plan, [&](std::vector<VdbGrid> made) {
        for (std::size_t g = 0; g < made.size(); ++g) of_grids.at(g).push_back(std::move(made[g]));
    });
    std::vector<VdbGrid> joined;
    for (std::vector<VdbGrid>& blocks : of_grids) joined.push_back(vdb().join_grids(std::move(blocks)));
    return {std::move(joined), std::move(facts)};
}

Facts write_bricks_vdb(const std::string& input, const BricksToVoxels& what, const VdbOutput& output) {
    const std::uint64_t memory = output.memory_bytes > 0 ? output.memory_bytes : kDefaultMemory;
    const BlockPlan plan(what, static_cast<double>(memory), {});
    VdbParts parts(output, memory);
    std::vector<GridSum> sums;
    Facts writing;
    Facts facts = make_blocks(what, plan, [&](const std::vector<VdbGrid>& made) {
        if (!has_voxels(made)) return;
        add(sums, made);
        writing.timed(what.options.progress, "write", [&] { parts.write(made, parts.count()); });
    });
    facts.merge(writing);
    if (parts.active_voxels() == 0) throw no_voxels(input, "try a smaller --voxel-size");
    facts.merge(parts.finish(input, what.options.voxel_size_world, what.options.progress));
    if (facts.find("grids") == nullptr) facts["grids"] = list_of(sums);
    return facts;
}

}  // namespace subvol::cli
