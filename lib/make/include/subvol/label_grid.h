// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "subvol/vec.h"

namespace subvol {

/// Voxels with integer labels, such as the tissues of a scan or the grains of a rock. 0, and all that no block has, is outside.
/// Blocks of one label alone take no memory for their voxels.
///
/// The centre of voxel (i, j, k) is at world = to_world · (i, j, k) + origin. The axes may be turned, mirrored or oblique.
class LabelGrid {
public:
    static constexpr int kSide = 8;  ///< voxels along each side of a block
    static constexpr std::size_t kVoxels = 512;
    static constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 31;  ///< that blocks may have in all
    /// Block (a, b, c) begins at voxel (8a, 8b, 8c).
    using At = std::array<std::int32_t, 3>;
    using Voxels = std::array<std::int32_t, kVoxels>;  ///< of a block, the first axis fastest

    /// throws: Error(InvalidInput) if a number is not finite, or if voxels have no volume
    explicit LabelGrid(const Mat3& to_world = Mat3(1), const Vec3& origin = Vec3(0.0));

    /// Sets a block.
    ///
    /// throws: Error(InvalidInput) if there would be more than `kMostVoxels`, or if a label is below 0
    void set(const At& block, const Voxels& labels);
    void set(const At& block, std::int32_t label);

    /// A block: its voxels, or null where all have one label.
    struct Block {
        std::int32_t label = 0;
        std::unique_ptr<const Voxels> voxels{};

        [[nodiscard]] std::int32_t at(std::size_t voxel) const { return voxels ? (*voxels)[voxel] : label; }
    };
    /// In the order of their places, without those that are outside.
    [[nodiscard]] const std::map<At, Block>& blocks() const { return blocks_; }
    /// Null: outside.
    [[nodiscard]] const Block* find(const At& block) const;

    [[nodiscard]] const Mat3& to_world() const { return to_world_; }
    [[nodiscard]] const Vec3& origin() const { return origin_; }

private:
    Mat3 to_world_;
    Vec3 origin_;
    std::map<At, Block> blocks_;
};

/// Sets the voxels of a box of a grid, from voxel (0, 0, 0), with labels that come one after another, the first axis fastest.
/// Holds no more than eight layers of them.
class LabelRows {
public:
    /// throws: Error(InvalidInput) if a side is 0, or there are more than `LabelGrid::kMostVoxels`
    LabelRows(LabelGrid& grid, const std::array<std::size_t, 3>& size);

    /// The next labels.
    ///
    /// throws: Error(InvalidInput) if there are too many, or if one is not from 0 to 2^31−1: names the voxel
    void take(std::span<const std::int64_t> labels);

    /// throws: Error(InvalidInput) if there were too few
    void finish();

private:
    void store();

    LabelGrid& grid_;
    std::array<std::size_t, 3> size_;
    std::size_t layer_ = 0, taken_ = 0;
    std::vector<std::int32_t> layers_;  // those since the last blocks
};

}  // namespace subvol
