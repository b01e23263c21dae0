// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Integer voxel coordinates, and a box of them that includes both ends.
using VoxelCoord = std::array<int, 3>;
struct VoxelBox {
    VoxelCoord lower, upper;

    [[nodiscard]] bool empty() const { return lower[0] > upper[0] || lower[1] > upper[1] || lower[2] > upper[2]; }
};

[[nodiscard]] VoxelBox common(const VoxelBox& a, const VoxelBox& b);

inline constexpr int kLeafSide = 8;  // voxels, as in OpenVDB
inline constexpr std::size_t kLeafVoxels = 512;
inline constexpr int kBrickLeaves = 4;  // along each axis
inline constexpr int kBrickSide = kBrickLeaves * kLeafSide;

/// The layer of bricks that contains a voxel, along one axis.
[[nodiscard]] constexpr int brick_layer(int voxel) {
    static_assert(kBrickSide == 32);
    return voxel >> 5;  // rounds down for negative voxels too
}

/// 8³ voxels, numbered x·64 + y·8 + z.
struct VoxelLeaf {
    explicit VoxelLeaf(std::size_t channels) : values(std::make_unique<float[]>(channels * kLeafVoxels)) {}

    std::array<std::uint64_t, 8> active{};  ///< bit z + 8 y of word x
    /// 512 numbers per channel, one channel after the other; 0 where inactive; whole numbers are stored as their bits.
    std::unique_ptr<float[]> values;

    [[nodiscard]] bool empty() const;
    [[nodiscard]] std::size_t active_count() const;
};

/// 4³ leaves, filled by one thread at a time. A leaf exists once one of its voxels is active.
struct VoxelBrick {
    VoxelCoord origin{};
    std::array<std::unique_ptr<VoxelLeaf>, std::size_t{kBrickLeaves} * kBrickLeaves * kBrickLeaves> leaves;
    std::vector<Index> cells;        ///< the cells of the current batch that may fill voxels of the brick
    std::vector<VoxelBox> doubtful;  ///< boxes of folded cells, which may have filled voxels outside the mesh

    [[nodiscard]] VoxelBox box() const;
    /// The lowest voxel of a leaf.
    [[nodiscard]] VoxelCoord leaf_origin(std::size_t leaf) const;
};

/// The bricks that are not empty.
class VoxelBricks {
public:
    explicit VoxelBricks(std::size_t channels) : channels_(channels) {}

    [[nodiscard]] std::size_t channels() const { return channels_; }

    /// Lists a cell in all bricks that a box of voxels touches.
    void enter(Index cell, const VoxelBox& box);
    /// The bricks in which cells were listed since the last call, in the order of their first cells.
    [[nodiscard]] std::vector<VoxelBrick*> take_entered();

    /// The leaf that contains a voxel; created if it does not exist.
    [[nodiscard]] VoxelLeaf& leaf_at(const VoxelCoord& voxel);

    /// Stores a leaf. origin: its lowest voxel
    void put_leaf(const VoxelCoord& origin, std::unique_ptr<VoxelLeaf> leaf);

    /// All bricks, in no order.
    [[nodiscard]] std::vector<VoxelBrick*> all() const;

    /// Moves all bricks out, in the order of their origins.
    [[nodiscard]] std::vector<std::unique_ptr<VoxelBrick>> release();

private:
    [[nodiscard]] VoxelBrick& brick_at(const VoxelCoord& origin);
    [[nodiscard]] std::unique_ptr<VoxelLeaf>& slot_of(const VoxelCoord& voxel);

    struct Hash {
        std::size_t operator()(const VoxelCoord& c) const;
    };

    std::size_t channels_;
    std::unordered_map<VoxelCoord, std::unique_ptr<VoxelBrick>, Hash> bricks_;
    std::array<VoxelBrick*, 64> recent_{};  // a cache of 4³ neighbouring bricks: consecutive cells lie close to each other
    std::vector<VoxelBrick*> entered_;
};

}  // namespace subvol::detail
