// SPDX-License-Identifier: Apache-2.0
#include "coarse_voxels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;

constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 31;

std::int32_t floor_division(std::int32_t a, std::int32_t n) {
    return a / n - (a % n < 0 ? 1 : 0);
}

openvdb::Coord block_of(const openvdb::Coord& voxel, std::int32_t n) {
    return {floor_division(voxel[0], n), floor_division(voxel[1], n), floor_division(voxel[2], n)};
}

Tree::ConstPtr without_tiles(const Tree::ConstPtr& tree) {
    if (tree->activeTileCount() == 0) return tree;
    if (tree->activeVoxelCount() > kMostVoxels) {
        throw Error(ErrorCode::InvalidInput, std::to_string(tree->activeVoxelCount()) + " active voxels are too many", {},
                    "at most 2³¹");
    }
    const Tree::Ptr dense(new Tree(*tree));
    dense->voxelizeActiveTiles();
    return dense;
}

/// Sums over the blocks of one coarse leaf, in the order of the added leaves.
class BlockSums {
public:
    void add(const Leaf& leaf, std::int32_t n) {
        for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
            const auto block = Leaf::coordToOffset(block_of(voxel.getCoord(), n));
            sums_[block] += static_cast<double>(*voxel);
            ++counts_[block];
        }
    }

    /// Null if no block is at least half active.
    std::unique_ptr<Leaf> leaf(const openvdb::Coord& origin, std::int32_t n, std::size_t& left_out) const {
        auto made = std::make_unique<Leaf>(origin, 0.0f, false);
        const std::int64_t whole = static_cast<std::int64_t>(n) * n * n;
        for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
            if (counts_[i] > 0 && 2 * counts_[i] >= whole) {
                made->setValueOn(i, static_cast<float>(sums_[i] / static_cast<double>(counts_[i])));
            } else {
                left_out += static_cast<std::size_t>(counts_[i]);
            }
        }
        return made->isEmpty() ? nullptr : std::move(made);
    }

private:
    std::vector<double> sums_ = std::vector<double>(Leaf::SIZE);
    std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(Leaf::SIZE);
};

/// A leaf of the fine tree. Leaves begin at multiples of eight, so each lies in one leaf of the coarse tree.
struct Part {
    openvdb::Coord origin;  // of the coarse leaf
    const Leaf* leaf;
};

std::vector<Part> parts_of(const Tree& tree, std::int32_t n) {
    std::vector<Part> parts;
    parts.reserve(tree.leafCount());
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        openvdb::Coord origin = block_of(leaf->origin(), n);
        parts.push_back({origin & ~static_cast<openvdb::Int32>(Leaf::DIM - 1), leaf.getLeaf()});
    }
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.origin < b.origin; });
    return parts;
}

}  // namespace

CoarseVoxels coarse_voxels(const Tree::ConstPtr& tree, int n) {
    const Tree::ConstPtr fine = without_tiles(tree);
    if (n == 1) return {fine, 0};
    const std::vector<Part> parts = parts_of(*fine, n);
    std::vector<std::size_t> begins;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (i == 0 || parts[i].origin != parts[i - 1].origin) begins.push_back(i);
    }
    const std::size_t count = begins.size();
    begins.push_back(parts.size());
    std::vector<std::unique_ptr<Leaf>> leaves(count);
    std::vector<std::size_t> left_out(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
        BlockSums sums;
        for (std::size_t i = begins[k]; i < begins[k + 1]; ++i) sums.add(*parts[i].leaf, n);
        leaves[k] = sums.leaf(parts[begins[k]].origin, n, left_out[k]);
    });
    const Tree::Ptr coarse(new Tree(0.0f));
    CoarseVoxels result{coarse, 0};
    for (std::size_t k = 0; k < count; ++k) {
        if (leaves[k]) coarse->addLeaf(leaves[k].release());
        result.left_out += left_out[k];
    }
    return result;
}

}  // namespace subvol::detail
