// SPDX-License-Identifier: Apache-2.0
#include "check_voxels.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr double kMaxIndex = 1 << 30;     // leaves room in 32 bits for the sides of bricks and for neighbours
constexpr double kMaxActiveVoxels = 2e9;  // 8 GB a field
constexpr double kMaxBrickEntries = 5e7;  // a few GB

[[noreturn]] void throw_too_fine(double voxel_size, const std::string& why, double right_size) {
    throw Error(ErrorCode::InvalidInput, why, "voxel size " + number_text(voxel_size),
                std::isfinite(right_size) ? "at least " + number_text(right_size) + " would be right"
                                          : "a mesh whose volume is a finite number");
}

/// all: the sum of absolute volumes; oriented: the sum of signed volumes
struct Volume {
    double all = 0, oriented = 0;
};

/// The sum over the six tetrahedra about the long diagonal, taken in pairs that share a face.
Volume volume_of(const HexMesh& mesh, std::size_t cell) {
    const auto& corners = mesh.cells[cell];
    const auto p = [&](std::size_t k) -> const Vec3& { return mesh.points[corners[k]]; };
    const Vec3 sum =
        glm::cross(p(1) - p(0), p(2) - p(5)) + glm::cross(p(4) - p(0), p(5) - p(7)) + glm::cross(p(3) - p(0), p(7) - p(2));
    const double volume = glm::dot(p(6) - p(0), sum) / 6.0;
    return {std::abs(volume), volume};
}

Volume volume_of(const HexMesh& mesh, std::span<const Index> numbers) {
    const auto add = [](const Volume& a, const Volume& b) { return Volume{a.all + b.all, a.oriented + b.oriented}; };
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, mesh.cells.size(), 4096), Volume{},
        [&](const auto& range, Volume sum) {
            for (std::size_t c = range.begin(); c < range.end(); ++c) {
                if (numbers.empty() || numbers[c] != kNone) sum = add(sum, volume_of(mesh, c));
            }
            return sum;
        },
        add);
}

double brick_count(const VoxelBox& box) {
    if (box.empty()) return 0;
    double count = 1;
    for (std::size_t d = 0; d < 3; ++d) {
        count *= brick_layer(box.upper[d]) - brick_layer(box.lower[d]) + 1;
    }
    return count;
}

}  // namespace

double check_voxel_count(const HexMesh& mesh, const ToVoxels& to_voxels, std::span<const Index> numbers) {
    const Box box = bounds(mesh);
    double farthest = 0;
    for (int k = 0; k < 8; ++k) {
        const Vec3 corner(k & 1 ? box.upper.x : box.lower.x, k & 2 ? box.upper.y : box.lower.y,
                          k & 4 ? box.upper.z : box.lower.z);
        const Vec3 reach = glm::abs(to_voxels(corner));
        farthest = std::max({farthest, reach.x, reach.y, reach.z});
    }
    if (!(farthest < kMaxIndex)) {
        throw_too_fine(to_voxels.voxel_size, "voxel numbers count from the world's origin and would not fit 32 bits",
                       1.01 * to_voxels.voxel_size * farthest / kMaxIndex);
    }
    const double in_voxels = glm::determinant(to_voxels.linear / to_voxels.voxel_size);
    const Volume volume = volume_of(mesh, numbers);
    const double voxels = volume.all * std::abs(in_voxels);
    if (!(voxels <= kMaxActiveVoxels)) {
        throw_too_fine(to_voxels.voxel_size, "the mesh would fill more than 2e9 voxels",
                       1.01 * to_voxels.voxel_size * std::cbrt(voxels / kMaxActiveVoxels));
    }
    return volume.oriented * in_voxels;
}

void check_brick_count(std::span<const VoxelBox> boxes, double voxel_size) {
    double count = 0;
    for (const VoxelBox& box : boxes) count += brick_count(box);
    if (!(count <= kMaxBrickEntries)) {
        throw_too_fine(voxel_size, "the cells' bounding boxes hold too many voxels", 2 * voxel_size);
    }
}

}  // namespace subvol::detail
