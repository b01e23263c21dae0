// SPDX-License-Identifier: Apache-2.0
#include "voxel_bricks.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "subvol/detail/word_hash.h"

namespace subvol::detail {

namespace {

constexpr int kInBrick = ~(kBrickSide - 1);  // rounds down for negative voxels too

}  // namespace

VoxelBox common(const VoxelBox& a, const VoxelBox& b) {
    VoxelBox box;
    for (std::size_t d = 0; d < 3; ++d) {
        box.lower[d] = std::max(a.lower[d], b.lower[d]);
        box.upper[d] = std::min(a.upper[d], b.upper[d]);
    }
    return box;
}

bool VoxelLeaf::empty() const {
    return std::ranges::all_of(active, [](std::uint64_t word) { return word == 0; });
}

std::size_t VoxelLeaf::active_count() const {
    std::size_t count = 0;
    for (const std::uint64_t word : active) count += static_cast<std::size_t>(std::popcount(word));
    return count;
}

VoxelBox VoxelBrick::box() const {
    return {origin, {origin[0] + kBrickSide - 1, origin[1] + kBrickSide - 1, origin[2] + kBrickSide - 1}};
}

VoxelCoord VoxelBrick::leaf_origin(std::size_t leaf) const {
    const int l = static_cast<int>(leaf);
    return {origin[0] + kLeafSide * (l / (kBrickLeaves * kBrickLeaves)),
            origin[1] + kLeafSide * (l / kBrickLeaves % kBrickLeaves), origin[2] + kLeafSide * (l % kBrickLeaves)};
}

std::size_t VoxelBricks::Hash::operator()(const VoxelCoord& c) const {
    std::uint64_t h = 0;
    for (const int x : c) h = detail::hash_with(h, static_cast<std::uint32_t>(brick_layer(x)));
    return h ^ h >> 32;
}

VoxelBrick& VoxelBricks::brick_at(const VoxelCoord& origin) {
    std::size_t slot = 0;
    for (const int x : origin) slot = 4 * slot + static_cast<std::size_t>(brick_layer(x) & 3);
    VoxelBrick*& recent = recent_[slot];
    const auto is_at = [&](const VoxelCoord& o) { return o[0] == origin[0] && o[1] == origin[1] && o[2] == origin[2]; };
    if (recent && is_at(recent->origin)) return *recent;
    auto& brick = bricks_[origin];
    if (!brick) {
        brick = std::make_unique<VoxelBrick>();
        brick->origin = origin;
    }
    recent = brick.get();
    return *brick;
}

void VoxelBricks::enter(Index cell, const VoxelBox& box) {
    if (box.empty()) return;
    for (int x = box.lower[0] & kInBrick; x <= box.upper[0]; x += kBrickSide) {
        for (int y = box.lower[1] & kInBrick; y <= box.upper[1]; y += kBrickSide) {
            for (int z = box.lower[2] & kInBrick; z <= box.upper[2]; z += kBrickSide) {
                VoxelBrick& brick = brick_at({x, y, z});
                if (brick.cells.empty()) entered_.push_back(&brick);
                brick.cells.push_back(cell);
            }
        }
    }
}

std::unique_ptr<VoxelLeaf>& VoxelBricks::slot_of(const VoxelCoord& voxel) {
    VoxelBrick& brick = brick_at({voxel[0] & kInBrick, voxel[1] & kInBrick, voxel[2] & kInBrick});
    std::size_t slot = 0;
    for (std::size_t d = 0; d < 3; ++d) {
        slot = slot * kBrickLeaves + static_cast<std::size_t>((voxel[d] - brick.origin[d]) / kLeafSide);
    }
    return brick.leaves[slot];
}

VoxelLeaf& VoxelBricks::leaf_at(const VoxelCoord& voxel) {
    auto& leaf = slot_of(voxel);
    if (!leaf) leaf = std::make_unique<VoxelLeaf>(channels_);
    return *leaf;
}

void VoxelBricks::put_leaf(const VoxelCoord& origin, std::unique_ptr<VoxelLeaf> leaf) {
    slot_of(origin) = std::move(leaf);
}

std::vector<VoxelBrick*> VoxelBricks::take_entered() {
    return std::exchange(entered_, {});
}

std::vector<VoxelBrick*> VoxelBricks::all() const {
    std::vector<VoxelBrick*> bricks;
    for (const auto& [origin, brick] : bricks_) bricks.push_back(brick.get());
    return bricks;
}

std::vector<std::unique_ptr<VoxelBrick>> VoxelBricks::release() {
    std::vector<std::unique_ptr<VoxelBrick>> all;
    for (auto& [origin, brick] : bricks_) all.push_back(std::move(brick));
    bricks_.clear();
    recent_ = {};
    std::ranges::sort(all, {}, [](const auto& brick) { return brick->origin; });
    return all;
}

}  // namespace subvol::detail
