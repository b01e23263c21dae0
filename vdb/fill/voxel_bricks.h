// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Integer voxel coordinates, and a box of them with both ends in it.
using VoxelCoord = std::array<int, 3>;
struct VoxelBox {
    VoxelCoord lower, upper;

    [[nodiscard]] bool empty() const { return lower[0] > upper[0] || lower[1] > upper[1] || lower[2] > upper[2]; }
};

[[nodiscard]] VoxelBox common(const VoxelBox& a, const VoxelBox& b);

inline constexpr int kLeafSide = 8;  // voxels; OpenVDB's leaf
inline constexpr std::size_t kLeafVoxels = 512;
inline constexpr int kBrickLeaves = 4;  // a side
inline constexpr int kBrickSide = kBrickLeaves * kLeafSide;

/// The layer of bricks that a voxel lies in, along an axis.
[[nodiscard]] constexpr int brick_layer(int voxel) {
    static_assert(kBrickSide == 32);
    return voxel >> 5;  // rounds down for negative voxels too
}

/// 8³ voxels, numbered x·64 + y·8 + z.
///
/// active: bit z + 8 y of word x
/// values: 512 of every channel, one channel after the other; 0 where inactive. Whole numbers are kept as their bits
struct VoxelLeaf {
    explicit VoxelLeaf(std::size_t channels) : values(std::make_unique<float[]>(channels * kLeafVoxels)) {}

    std::array<std::uint64_t, 8> active{};
    std::unique_ptr<float[]> values;

    [[nodiscard]] bool empty() const;
    [[nodiscard]] std::size_t active_count() const;
};

/// 4³ leaves that one thread fills at a time; a leaf is there once a voxel of it is active.
///
/// cells:    of the batch that is being rasterized, those that may fill voxels of it
/// doubtful: where folded cells lie, which may have filled voxels outside the mesh
struct VoxelBrick {
    VoxelCoord origin{};
    std::array<std::unique_ptr<VoxelLeaf>, std::size_t{kBrickLeaves} * kBrickLeaves * kBrickLeaves> leaves;
    std::vector<Index> cells;
    std::vector<VoxelBox> doubtful;

    [[nodiscard]] VoxelBox box() const;
    /// The lowest voxel of a leaf.
    [[nodiscard]] VoxelCoord leaf_origin(std::size_t leaf) const;
};

/// The bricks that something was found in.
class VoxelBricks {
public:
    explicit VoxelBricks(std::size_t channels) : channels_(channels) {}

    [[nodiscard]] std::size_t channels() const { return channels_; }

    /// Enters a cell into all bricks that a box of voxels touches.
    void enter(Index cell, const VoxelBox& box);
    /// The bricks entered since the last call, in the order of their first cells.
    [[nodiscard]] std::vector<VoxelBrick*> take_entered();

    /// The leaf that holds a voxel; it is made if it is not there.
    [[nodiscard]] VoxelLeaf& leaf_at(const VoxelCoord& voxel);

    /// Enters a leaf of its own making. origin: its lowest voxel
    void put_leaf(const VoxelCoord& origin, std::unique_ptr<VoxelLeaf> leaf);

    /// All bricks in the order of their origins; none is left here.
    [[nodiscard]] std::vector<std::unique_ptr<VoxelBrick>> release();

private:
    [[nodiscard]] VoxelBrick& brick_at(const VoxelCoord& origin);
    [[nodiscard]] std::unique_ptr<VoxelLeaf>& slot_of(const VoxelCoord& voxel);

    struct Hash {
        std::size_t operator()(const VoxelCoord& c) const;
    };

    std::size_t channels_;
    std::unordered_map<VoxelCoord, std::unique_ptr<VoxelBrick>, Hash> bricks_;
    std::array<VoxelBrick*, 64> recent_{};  // of 4³ bricks next to each other: cells that follow each other lie close
    std::vector<VoxelBrick*> entered_;
};

}  // namespace subvol::detail
