// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>
#include "openvdb_grids.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "brick_grids.h"
#include "distance_band.h"
#include "grid_setup.h"
#include "level_set.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/points_frame.h"
#include "subvol/error.h"
#include "subvol/rbf_field.h"
#include "surface_columns.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kMostVoxels = 2e9;
constexpr double kMostCrossings = 1e8;  // 2.4 GB
constexpr double kMaxIndex = 1 << 30;

[[noreturn]] void throw_too_fine(const ToVoxels& to_voxels) {
    throw Error(ErrorCode::InvalidInput, "the points would fill more than 2e9 voxels, or voxel indices would not fit 32 bits",
                "voxel size " + number_text(to_voxels.voxel_size), "larger voxels");
}

/// A box in voxel space.
///
/// throws: Error(InvalidInput) if voxel indices do not fit 32 bits
Box in_voxels(const Box& world, const ToVoxels& to_voxels) {
    Box box;
    for (int k = 0; k < 8; ++k) {
        box.add(to_voxels({k & 1 ? world.upper.x : world.lower.x, k & 2 ? world.upper.y : world.lower.y,
                           k & 4 ? world.upper.z : world.lower.z}));
    }
    for (const Vec3& corner : {box.lower, box.upper}) {
        const Vec3 reach = glm::abs(corner);
        if (!(std::max({reach.x, reach.y, reach.z}) < kMaxIndex)) throw_too_fine(to_voxels);
    }
    return box;
}

std::vector<VoxelTriangle> triangles_of(const Surface& surface, const ToVoxels& to_voxels) {
    std::vector<VoxelTriangle> triangles;
    for (const auto& [a, b, c] : surface.triangles) {
        triangles.push_back({to_voxels(surface.points[a]), to_voxels(surface.points[b]), to_voxels(surface.points[c])});
    }
    return triangles;
}

/// throws: Error(InvalidInput) if a boundary encloses too many voxels, or too many columns of voxels cross it
void check_size(std::span<const VoxelTriangle> boundary, const ToVoxels& to_voxels) {
    double volume = 0, crossings = 0;
    for (const auto& [a, b, c] : boundary) {
        volume += glm::dot(a, glm::cross(b, c)) / 6;
        crossings += std::abs(glm::cross(b - a, c - a).z) / 2;
    }
    if (!(std::abs(volume) <= kMostVoxels && crossings <= kMostCrossings)) throw_too_fine(to_voxels);
}

/// The voxels whose centres lie inside a boundary.
VoxelBricks voxels_within(std::span<const VoxelTriangle> boundary, const ToVoxels& to_voxels, std::size_t channels) {
    check_size(boundary, to_voxels);
    VoxelBricks bricks(channels);
    double count = 0;
    SurfaceColumns(boundary).for_each_run([&](const VoxelCoord& lowest, int upper) {
        count += double{1} * upper - lowest[2] + 1;
        if (count > kMostVoxels) throw_too_fine(to_voxels);
        for (VoxelCoord voxel = lowest; voxel[2] <= upper; ++voxel[2]) {
            const int in_word = (voxel[1] & (kLeafSide - 1)) * kLeafSide + (voxel[2] & (kLeafSide - 1));
            bricks.leaf_at(voxel).active[static_cast<std::size_t>(voxel[0] & (kLeafSide - 1))] |= std::uint64_t{1} << in_word;
        }
    });
    return bricks;
}

/// All voxels of the leaves that the support of any kernel may touch.
VoxelBricks voxels_near(const RbfVolume& volume, const ToVoxels& to_voxels, std::size_t channels) {
    VoxelBricks bricks(channels);
    double leaves = 0;
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const auto& [xx, xy, xz, yy, yz, zz] = volume.frames[i];
        const Vec3 reach(std::sqrt(xx), std::sqrt(yy), std::sqrt(zz));  // of the support ellipsoid, along the axes
        const Box box = in_voxels({volume.centers[i] - reach, volume.centers[i] + reach}, to_voxels);
        const auto leaf = [](double voxel) { return static_cast<int>(std::floor(voxel)) & ~(kLeafSide - 1); };
        const Vec3 side = box.size();
        if (!(side.x * side.y * side.z <= kMostVoxels)) throw_too_fine(to_voxels);  // before a leaf of it is made
        for (int x = leaf(box.lower.x); x <= box.upper.x; x += kLeafSide) {
            for (int y = leaf(box.lower.y); y <= box.upper.y; y += kLeafSide) {
                for (int z = leaf(box.lower.z); z <= box.upper.z; z += kLeafSide) {
                    VoxelLeaf& made = bricks.leaf_at({x, y, z});
                    if (made.active[0] == 0) leaves += 1;
                    if (leaves * kLeafVoxels > kMostVoxels) throw_too_fine(to_voxels);
                    made.active.fill(~std::uint64_t{0});
                }
            }
        }
    }
    return bricks;
}

/// Sets the values of the active voxels of a leaf. Where a field has no value the voxel is 0, or with `drop` inactive.
void evaluate(std::span<const RbfField> fields, const ToVoxels& to_voxels, const Mat3& to_world, bool drop,
              const VoxelCoord& origin, VoxelLeaf& leaf) {
    for (std::size_t i = 0; i < kLeafVoxels; ++i) {
        const std::uint64_t bit = std::uint64_t{1} << i % 64;
        if ((leaf.active[i / 64] & bit) == 0) continue;
        const int n = static_cast<int>(i);
        const Vec3 voxel(origin[0] + n / 64, origin[1] + n / 8 % 8, origin[2] + n % 8);
        const Vec3 x = to_world * (to_voxels.voxel_size * voxel - to_voxels.offset);
        for (std::size_t f = 0; f < fields.size(); ++f) {
            const std::optional<double> value = fields[f].value(x);
            if (!value && drop) leaf.active[i / 64] &= ~bit;
            leaf.values[f * kLeafVoxels + i] = static_cast<float>(value.value_or(0));
        }
    }
}

/// The bricks with their values, without leaves that have no active voxel.
VoxelBricks evaluated(VoxelBricks bricks, std::span<const RbfField> fields, const ToVoxels& to_voxels, bool drop,
                      Progress* progress) {
    const Mat3 to_world = glm::inverse(to_voxels.linear);
    VoxelBricks result(bricks.channels());
    auto all = bricks.release();
    constexpr std::size_t kBatch = 64;
    for (std::size_t first = 0; first < all.size(); first += kBatch) {
        report_progress(progress, "kernel sums", first, all.size());
        const auto batch = std::span(all).subspan(first, std::min(kBatch, all.size() - first));
        tbb::parallel_for(std::size_t{0}, batch.size() * batch[0]->leaves.size(), [&](std::size_t i) {
            auto& brick = *batch[i / batch[0]->leaves.size()];
            const std::size_t l = i % brick.leaves.size();
            if (brick.leaves[l]) evaluate(fields, to_voxels, to_world, drop, brick.leaf_origin(l), *brick.leaves[l]);
        });
        for (auto& brick : batch) {
            for (std::size_t l = 0; l < brick->leaves.size(); ++l) {
                auto& leaf = brick->leaves[l];
                if (leaf && !leaf->empty()) result.put_leaf(brick->leaf_origin(l), std::move(leaf));
            }
            brick.reset();
        }
    }
    return result;
}

}  // namespace

std::vector<VdbGrid> rasterize_points(const RbfVolume& volume, std::span<const std::size_t> channels,
                                      const RasterizeOptions& options) {
    if (channels.empty()) throw Error(ErrorCode::InvalidInput, "no field is named to be rasterized");
    const ToVoxels to_voxels = to_voxels_of(box_of(volume), options);
    check_representable(to_voxels.voxel_size);
    std::ignore = in_voxels(box_of(volume), to_voxels);
    const bool bounded = !volume.boundary.triangles.empty();
    if (options.level_set) {
        check_level_set(options);
        if (!bounded) throw Error(ErrorCode::InvalidInput, "a level set needs a boundary, but these points have none");
    }
    std::vector<RbfField> fields;
    std::vector<GridOfChannels> wanted;
    for (const std::size_t channel : channels) {
        fields.emplace_back(
            volume, bounded ? RbfFieldOptions{.channel = channel, .least_weight = 0} : RbfFieldOptions{.channel = channel});
        wanted.push_back({volume.channels[channel].name, GridKind::Float, wanted.size()});
    }
    openvdb::initialize();
    const auto boundary = triangles_of(volume.boundary, to_voxels);
    VoxelBricks voxels =
        bounded ? voxels_within(boundary, to_voxels, fields.size()) : voxels_near(volume, to_voxels, fields.size());
    auto grids = make_grids(evaluated(std::move(voxels), fields, to_voxels, !bounded, options.progress), wanted);
    grids.front()->setGridClass(openvdb::GRID_FOG_VOLUME);
    const auto mask = mask_of(*grids.front());
    if (options.mask) grids.push_back(mask);
    if (options.level_set) {
        const double half_width = options.level_set->half_width_voxels;
        check_band(boundary, half_width);
        grids.push_back(level_set(distance_band(boundary, half_width, {}), *mask, to_voxels.voxel_size, half_width));
        grids.back()->setName(options.level_set->name);
    }
    std::vector<VdbGrid> result;
    for (const auto& grid : grids) {
        describe(*grid, to_voxels, options, frame_of(volume));
        result.push_back(make_vdb_grid(grid));
    }
    return result;
}

}  // namespace subvol
