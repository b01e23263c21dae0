// SPDX-License-Identifier: Apache-2.0
// Bricks of voxels become OpenVDB trees, sixteen bricks (1024 leaves) at a time:
//
//     VoxelBricks   sorted by origin; a brick has up to 4³ leaves of 8³ voxels with all channels
//          |
//          |  convert: in parallel, for every grid: a VoxelLeaf becomes an OpenVDB leaf, or an active tile where all 512
//          v           voxels are active and have the same bits
//     ConvertedLeaf[]        then the bricks of the batch are freed: only 16 bricks are ever in memory twice
//          |
//          |  add_to_tree: one thread per batch, because the inner nodes of a tree are not thread-safe
//          v
//     tree          root - 32³ nodes - 16³ nodes - 8³ leaves [museth2013]; finally tiles of one value are merged (prune)
#include "brick_grids.h"

#include <openvdb/tools/Prune.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <span>

namespace subvol::detail {

namespace {

constexpr std::size_t kBricksAtOnce = 16;  // bricks

openvdb::Coord coord_of(const VoxelCoord& c) {
    return {c[0], c[1], c[2]};
}

/// A voxel's value of one type, from the channels of a leaf.
template <class Value>
Value value_of(const float* values, std::size_t i) {
    if constexpr (std::is_same_v<Value, float>) {
        return values[i];
    } else if constexpr (std::is_same_v<Value, std::int32_t>) {
        return std::bit_cast<std::int32_t>(values[i]);
    } else {
        return {values[i], values[i + kLeafVoxels], values[i + 2 * kLeafVoxels]};
    }
}

bool is_constant(const VoxelLeaf& leaf, const float* values, std::size_t channels) {
    const auto full = [](std::uint64_t word) { return word == ~std::uint64_t{0}; };
    if (!std::ranges::all_of(leaf.active, full)) return false;
    for (std::size_t c = 0; c < channels; ++c) {
        const float* of_channel = values + c * kLeafVoxels;
        const auto bits = std::bit_cast<std::uint32_t>(of_channel[0]);
        if (!std::all_of(of_channel, of_channel + kLeafVoxels,
                         [=](float v) { return std::bit_cast<std::uint32_t>(v) == bits; })) {
            return false;
        }
    }
    return true;
}

class GridMaker {
public:
    virtual ~GridMaker() = default;
    /// Makes the leaves and tiles of a batch of bricks, in parallel.
    virtual void convert(std::span<const std::unique_ptr<VoxelBrick>> bricks) = 0;
    virtual void add_to_tree() = 0;
    virtual openvdb::GridBase::Ptr finish() = 0;
};

template <class Grid>
class GridMakerOf : public GridMaker {
    using Leaf = typename Grid::TreeType::LeafNodeType;
    using Value = typename Grid::ValueType;

public:
    explicit GridMakerOf(std::size_t channel) : channel_(channel), grid_(Grid::create()) {}

    void convert(std::span<const std::unique_ptr<VoxelBrick>> bricks) override {
        constexpr std::size_t kLeaves = std::tuple_size_v<decltype(VoxelBrick::leaves)>;
        made_ = std::vector<ConvertedLeaf>(bricks.size() * kLeaves);
        tbb::parallel_for(std::size_t{0}, made_.size(), [&](std::size_t i) {
            const VoxelBrick& brick = *bricks[i / kLeaves];
            if (const auto& leaf = brick.leaves[i % kLeaves]) made_[i] = make(*leaf, coord_of(brick.leaf_origin(i % kLeaves)));
        });
    }

    void add_to_tree() override {
        for (ConvertedLeaf& made : made_) {
            if (made.leaf) {
                grid_->tree().addLeaf(made.leaf.release());
            } else if (made.is_tile) {
                grid_->tree().addTile(1, made.origin, made.value, true);
                has_tiles_ = true;
            }
        }
    }

    openvdb::GridBase::Ptr finish() override {
        made_.clear();
        if (has_tiles_) openvdb::tools::prune(grid_->tree());
        return grid_;
    }

private:
    struct ConvertedLeaf {
        std::unique_ptr<Leaf> leaf;
        bool is_tile = false;
        openvdb::Coord origin;
        Value value{};
    };

    ConvertedLeaf make(const VoxelLeaf& voxels, const openvdb::Coord& origin) const {
        const float* values = voxels.values.get() + channel_ * kLeafVoxels;
        // NOLINTNEXTLINE(bugprone-sizeof-expression): the number of channels, one or three
        if (is_constant(voxels, values, sizeof(Value) / sizeof(float)))
            return {nullptr, true, origin, value_of<Value>(values, 0)};
        auto leaf = std::make_unique<Leaf>(origin, Value(0), false);
        Value* out = leaf->buffer().data();
        for (std::size_t i = 0; i < kLeafVoxels; ++i) out[i] = value_of<Value>(values, i);
        typename Leaf::NodeMaskType mask;
        for (std::size_t w = 0; w < voxels.active.size(); ++w) {
            mask.template getWord<std::uint64_t>(static_cast<openvdb::Index>(w)) = voxels.active[w];
        }
        leaf->setValueMask(mask);
        return {std::move(leaf), false, origin, Value(0)};
    }

    std::size_t channel_;
    typename Grid::Ptr grid_;
    std::vector<ConvertedLeaf> made_;
    bool has_tiles_ = false;
};

std::unique_ptr<GridMaker> make_maker(const GridOfChannels& wanted) {
    switch (wanted.kind) {
        case GridKind::Vector:
            return std::make_unique<GridMakerOf<openvdb::Vec3SGrid>>(wanted.channel);
        case GridKind::Integer:
            return std::make_unique<GridMakerOf<openvdb::Int32Grid>>(wanted.channel);
        default:
            return std::make_unique<GridMakerOf<openvdb::FloatGrid>>(wanted.channel);
    }
}

}  // namespace

std::vector<openvdb::GridBase::Ptr> make_grids(VoxelBricks voxels, const std::vector<GridOfChannels>& wanted) {
    std::vector<std::unique_ptr<GridMaker>> makers;
    for (const GridOfChannels& grid : wanted) makers.push_back(make_maker(grid));
    auto bricks = voxels.release();
    for (std::size_t first = 0; first < bricks.size(); first += kBricksAtOnce) {
        const auto batch = std::span(bricks).subspan(first, std::min(kBricksAtOnce, bricks.size() - first));
        for (const auto& maker : makers) maker->convert(batch);
        for (auto& brick : batch) brick.reset();
        for (const auto& maker : makers) maker->add_to_tree();
    }
    std::vector<openvdb::GridBase::Ptr> grids;
    for (std::size_t g = 0; g < wanted.size(); ++g) {
        grids.push_back(makers[g]->finish());
        grids.back()->setName(wanted[g].name);
    }
    return grids;
}

}  // namespace subvol::detail
