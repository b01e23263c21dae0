// SPDX-License-Identifier: Apache-2.0
// The part of each voxel that the volume fills, estimated with 4³ samples.
//
//     +---------+     Samples are the voxels of a finer grid: sample s = 0 … 3 of voxel i lies at i + (s + ½)/4 − ½ along
//     | . . . . |     each axis, and `samples_within` maps that position to the whole number 4i + s. So the rasterizer that
//     | . . . . |     decides which centres lie inside decides it for samples too.
//     | . . . . |
//     | . . . . |     coverage = (active samples of the voxel) / 64
//     +---------+
//
// A brick of samples (32³) is a leaf of voxels (8³): each brick is counted by itself, with bit masks.
#include "coverage.h"

#include <bit>

namespace subvol::detail {

namespace {

/// How many of the 4³ samples of voxel (x, y, z) are active; the voxel takes half a leaf of samples along each axis.
int samples_in(const VoxelBrick& brick, std::size_t x, std::size_t y, std::size_t z) {
    const auto& leaf = brick.leaves[(x / 2 * kBrickLeaves + y / 2) * kBrickLeaves + z / 2];
    if (!leaf) return 0;
    const std::uint64_t square = std::uint64_t{0x0f0f0f0f} << (32 * (y % 2) + 4 * (z % 2));
    int count = 0;
    for (std::size_t i = 0; i < 4; ++i) count += std::popcount(leaf->active[4 * (x % 2) + i] & square);
    return count;
}

std::unique_ptr<VoxelLeaf> make_leaf(const VoxelBrick& samples) {
    auto leaf = std::make_unique<VoxelLeaf>(1);
    for (std::size_t i = 0; i < kLeafVoxels; ++i) {
        const int count = samples_in(samples, i / 64, i / 8 % 8, i % 8);
        if (count == 0) continue;
        leaf->active[i / 64] |= std::uint64_t{1} << i % 64;
        leaf->values[i] = static_cast<float>(count) / (kCoverageSamples * kCoverageSamples * kCoverageSamples);
    }
    return leaf;
}

}  // namespace

CellRequest samples_within(CellRequest request) {
    const double h = request.to_voxels.voxel_size;
    request.to_voxels.offset += Vec3(0.5 * h - 0.5 * h / kCoverageSamples);
    request.to_voxels.voxel_size = h / kCoverageSamples;
    request.fields.clear();
    request.cell_numbers = false;
    return request;
}

VoxelBricks coverage_of(VoxelBricks samples) {
    VoxelBricks voxels(1);
    for (auto& brick : samples.release()) {
        auto leaf = make_leaf(*brick);
        const VoxelCoord& o = brick->origin;
        if (!leaf->empty())
            voxels.put_leaf({o[0] / kCoverageSamples, o[1] / kCoverageSamples, o[2] / kCoverageSamples}, std::move(leaf));
        brick.reset();
    }
    return voxels;
}

}  // namespace subvol::detail
