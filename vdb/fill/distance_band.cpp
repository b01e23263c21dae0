// SPDX-License-Identifier: Apache-2.0
// Distances from a surface in a narrow band of half width w about it, by brute force on small sets of triangles:
//
//     . . . . . . . .      1. `enter`: each triangle is listed in the bricks (32³ voxels) that it is near to.
//     . . .____. . . .     2. `fill_leaf`: each leaf (8³) of a brick takes those triangles of the list that are near to it.
//     . __/ . .\__ . .        Each lowers d²(p) = min d²(p, triangle) at the centres p of its own box, grown by w.
//     ./. . . . . \_ .     3. Centres with d < w become active.
//     . . . . . . . .
//
// A triangle may be nearer than w to a cube of side³ centres with middle m only if d(m, triangle) ≤ w + √3 (side − 1)/2. The
// minimum does not depend on the order of triangles, and each task writes its own leaf: the result is the same for any number
// of threads.
#include "distance_band.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "subvol/detail/triangle_distance.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr double kMaxVoxels = 2e9;
constexpr double kMaxBricks = 5e7;

double squared_distance(const Vec3& p, const VoxelTriangle& triangle) {
    return detail::squared_distance(p, triangle[0], triangle[1], triangle[2]);
}

VoxelBox box_about(const VoxelTriangle& triangle, double half_width) {
    VoxelBox box;
    for (std::size_t d = 0; d < 3; ++d) {
        const int axis = static_cast<int>(d);
        const auto [low, high] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
        box.lower[d] = static_cast<int>(std::ceil(low - half_width));
        box.upper[d] = static_cast<int>(std::floor(high + half_width));
    }
    return box;
}

/// Whether a triangle may be nearer than `half_width` to a voxel of the cube of `side` voxels at `origin`.
bool is_near(const VoxelTriangle& triangle, const VoxelCoord& origin, int side, double half_width) {
    const double half = 0.5 * (side - 1);
    const Vec3 middle(origin[0] + half, origin[1] + half, origin[2] + half);
    const double reach = half_width + std::sqrt(3.0) * half;
    return !(squared_distance(middle, triangle) > reach * reach);
}

/// Lists each triangle in the bricks that it is near to.
void enter(std::span<const VoxelTriangle> triangles, double half_width, const std::optional<VoxelBox>& part,
           VoxelBricks& bricks) {
    constexpr int kInBrick = ~(kBrickSide - 1);
    for (Index t = 0; t < triangles.size(); ++t) {
        const VoxelBox whole = box_about(triangles[t], half_width), box = part ? common(whole, *part) : whole;
        if (box.empty()) continue;
        for (int x = box.lower[0] & kInBrick; x <= box.upper[0]; x += kBrickSide) {
            for (int y = box.lower[1] & kInBrick; y <= box.upper[1]; y += kBrickSide) {
                for (int z = box.lower[2] & kInBrick; z <= box.upper[2]; z += kBrickSide) {
                    if (!is_near(triangles[t], {x, y, z}, kBrickSide, half_width)) continue;
                    bricks.enter(t, {{x, y, z}, {x, y, z}});
                }
            }
        }
    }
}

std::unique_ptr<VoxelLeaf> fill_leaf(std::span<const VoxelTriangle> triangles, const std::vector<Index>& numbers,
                                     const VoxelCoord& origin, double half_width) {
    std::vector<Index> near;
    for (const Index t : numbers) {
        if (is_near(triangles[t], origin, kLeafSide, half_width)) near.push_back(t);
    }
    if (near.empty()) return nullptr;
    std::vector<double> best(kLeafVoxels, half_width * half_width);
    const VoxelBox within{origin, {origin[0] + kLeafSide - 1, origin[1] + kLeafSide - 1, origin[2] + kLeafSide - 1}};
    for (const Index t : near) {
        const VoxelBox box = common(box_about(triangles[t], half_width), within);
        for (int x = box.lower[0]; x <= box.upper[0]; ++x) {
            for (int y = box.lower[1]; y <= box.upper[1]; ++y) {
                const auto row = static_cast<std::size_t>((x - origin[0]) * 64 + (y - origin[1]) * 8);
                for (int z = box.lower[2]; z <= box.upper[2]; ++z) {
                    double& least = best[row + static_cast<std::size_t>(z - origin[2])];
                    const double squared = squared_distance(Vec3(x, y, z), triangles[t]);
                    if (squared < least) least = squared;
                }
            }
        }
    }
    auto leaf = std::make_unique<VoxelLeaf>(1);
    for (std::size_t i = 0; i < kLeafVoxels; ++i) {
        if (!(best[i] < half_width * half_width)) continue;
        leaf->active[i / 64] |= std::uint64_t{1} << i % 64;
        leaf->values[i] = static_cast<float>(std::sqrt(best[i]));
    }
    return leaf->empty() ? nullptr : std::move(leaf);
}

}  // namespace

void check_band(std::span<const VoxelTriangle> triangles, double half_width) {
    double area = 0, bricks = 0;
    for (const VoxelTriangle& t : triangles) {
        area += 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
        const VoxelBox box = box_about(t, half_width);
        double count = 1;
        for (std::size_t d = 0; d < 3; ++d) count *= (double{1} * box.upper[d] - box.lower[d]) / kBrickSide + 1;
        bricks += count;
    }
    if (2 * half_width * area <= kMaxVoxels && bricks <= kMaxBricks) return;
    throw Error(ErrorCode::InvalidInput, "the level set would hold too many voxels about the surface", {},
                "larger voxels, or a narrower band");
}

VoxelBricks distance_band(std::span<const VoxelTriangle> triangles, double half_width, const std::optional<VoxelBox>& part) {
    VoxelBricks bricks(1);
    enter(triangles, half_width, part, bricks);
    const std::vector<VoxelBrick*> entered = bricks.take_entered();
    tbb::parallel_for(std::size_t{0}, entered.size(), [&](std::size_t b) {
        VoxelBrick& brick = *entered[b];
        for (std::size_t l = 0; l < brick.leaves.size(); ++l) {
            brick.leaves[l] = fill_leaf(triangles, brick.cells, brick.leaf_origin(l), half_width);
        }
        brick.cells = {};
    });
    return bricks;
}

}  // namespace subvol::detail
