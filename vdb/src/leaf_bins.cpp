#include "leaf_bins.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>

#include "subvol/error.h"
#include "subvol/tetrahedra.h"

namespace subvol {

namespace {

constexpr double kMaxIndex = 1 << 30;             // leaves room for the sides of leaves and neighbours in 32 bits
constexpr double kMaxActiveVoxels = 2e9;          // 8 GB a field
constexpr std::uint64_t kMaxEntries = 400000000;  // 6.4 GB
constexpr double kGenerosity = 3e-6;              // voxels; above the shift of centres on a face and the rounding at 2³⁰

int leaf_of(int voxel) {
    return voxel >> 3;  // arithmetic: rounds down for negative voxels too
}

[[noreturn]] void throw_too_fine(double voxel_size, const std::string& why, double right_size) {
    std::ostringstream where, allowed;
    where << "voxel size " << voxel_size;
    allowed << "at least " << right_size << " would be right";
    throw Error(ErrorCode::InvalidInput, why, where.str(), allowed.str());
}

double volume_of(const HexMesh& mesh, Index cell) {
    double sum = 0;
    for (const auto& [a, b, c, d] : split_cell(mesh.cells[cell])) {
        const Vec3& p = mesh.points[a];
        sum += std::abs(glm::dot(mesh.points[b] - p, glm::cross(mesh.points[c] - p, mesh.points[d] - p)));
    }
    return sum / 6.0;
}

double volume_of(const HexMesh& mesh) {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, mesh.cells.size(), 4096), 0.0,
        [&](const auto& range, double sum) {
            for (std::size_t c = range.begin(); c < range.end(); ++c) sum += volume_of(mesh, static_cast<Index>(c));
            return sum;
        },
        std::plus<>());
}

void check_voxel_count(const HexMesh& mesh, double voxel_size) {
    const Box box = bounds(mesh);
    const Vec3 reach = glm::max(glm::abs(box.lower), glm::abs(box.upper));
    const double farthest = std::max({reach.x, reach.y, reach.z});
    if (!(farthest / voxel_size < kMaxIndex)) {
        throw_too_fine(voxel_size, "voxel numbers count from the world's origin and would not fit 32 bits",
                       1.01 * farthest / kMaxIndex);
    }
    const double volume = volume_of(mesh);
    if (!(volume / voxel_size / voxel_size / voxel_size <= kMaxActiveVoxels)) {
        throw_too_fine(voxel_size, "the mesh would fill more than 2e9 voxels", 1.01 * std::cbrt(volume / kMaxActiveVoxels));
    }
}

std::uint64_t leaf_count(const VoxelBox& voxels) {
    std::uint64_t count = 1;
    for (std::size_t d = 0; d < 3; ++d) {
        if (voxels.lower[d] > voxels.upper[d]) return 0;
        count *= static_cast<std::uint64_t>(leaf_of(voxels.upper[d]) - leaf_of(voxels.lower[d]) + 1);
    }
    return count;  // at most 2²⁸ a side and, by the check of the leaf box, below 2⁶³
}

void set_leaf_box(LeafBins& bins, const Box& box) {
    const VoxelBox voxels = voxels_in(box, bins.voxel_size);
    double total = 1;
    for (std::size_t d = 0; d < 3; ++d) {
        bins.first_leaf[d] = leaf_of(voxels.lower[d]);
        bins.leaves_per_side[d] = static_cast<std::uint64_t>(std::max(leaf_of(voxels.upper[d]) - bins.first_leaf[d] + 1, 1));
        total *= static_cast<double>(bins.leaves_per_side[d]);
    }
    constexpr double kMaxKeys = 0x1p62;
    if (total > kMaxKeys) {
        throw_too_fine(bins.voxel_size, "the bounding box holds too many voxels",
                       1.01 * bins.voxel_size * std::cbrt(total / kMaxKeys));
    }
}

void append_entries(const LeafBins& bins, const VoxelBox& voxels, Index cell, LeafCell* out) {
    if (leaf_count(voxels) == 0) return;
    const auto coordinate = [&](int voxel, std::size_t d) {
        return static_cast<std::uint64_t>(leaf_of(voxel) - bins.first_leaf[d]);
    };
    const auto& sides = bins.leaves_per_side;
    for (auto x = coordinate(voxels.lower[0], 0); x <= coordinate(voxels.upper[0], 0); ++x) {
        for (auto y = coordinate(voxels.lower[1], 1); y <= coordinate(voxels.upper[1], 1); ++y) {
            for (auto z = coordinate(voxels.lower[2], 2); z <= coordinate(voxels.upper[2], 2); ++z) {
                *out++ = {(x * sides[1] + y) * sides[2] + z, cell};
            }
        }
    }
}

std::vector<std::uint64_t> first_entries(const HexMesh& mesh, double voxel_size) {
    std::vector<std::uint64_t> first(mesh.cells.size() + 1);
    tbb::parallel_for(std::size_t{0}, mesh.cells.size(), [&](std::size_t c) {
        first[c + 1] = leaf_count(voxels_in(cell_box(mesh, static_cast<Index>(c)), voxel_size));
    });
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        if (first[c + 1] > kMaxEntries - first[c]) {
            throw_too_fine(voxel_size, "the cells' bounding boxes hold too many voxels", 2 * voxel_size);
        }
        first[c + 1] += first[c];
    }
    return first;
}

}  // namespace

VoxelCoord LeafBins::origin_of(std::size_t leaf) const {
    const std::uint64_t key = entries[offsets[leaf]].leaf;
    const std::array<std::uint64_t, 3> steps{key / leaves_per_side[2] / leaves_per_side[1],
                                             key / leaves_per_side[2] % leaves_per_side[1], key % leaves_per_side[2]};
    VoxelCoord origin;
    for (std::size_t d = 0; d < 3; ++d) origin[d] = (first_leaf[d] + static_cast<int>(steps[d])) * kLeafSide;
    return origin;
}

VoxelBox voxels_in(const Box& box, double voxel_size) {
    VoxelBox voxels;
    for (int d = 0; d < 3; ++d) {
        voxels.lower[static_cast<std::size_t>(d)] = static_cast<int>(std::ceil(box.lower[d] / voxel_size - kGenerosity));
        voxels.upper[static_cast<std::size_t>(d)] = static_cast<int>(std::floor(box.upper[d] / voxel_size + kGenerosity));
    }
    return voxels;
}

Box cell_box(const HexMesh& mesh, Index cell) {
    Box box;
    for (const Index p : mesh.cells[cell]) box.add(mesh.points[p]);
    return box;
}

LeafBins bin_cells(const HexMesh& mesh, double voxel_size, Progress* progress) {
    report_progress(progress, "sort cells into voxels", 0);
    check_voxel_count(mesh, voxel_size);
    LeafBins bins;
    bins.voxel_size = voxel_size;
    set_leaf_box(bins, bounds(mesh));

    const auto first = first_entries(mesh, voxel_size);
    bins.entries.resize(first.back());
    tbb::parallel_for(std::size_t{0}, mesh.cells.size(), [&](std::size_t c) {
        const auto cell = static_cast<Index>(c);
        append_entries(bins, voxels_in(cell_box(mesh, cell), voxel_size), cell, bins.entries.data() + first[c]);
    });
    report_progress(progress, "sort cells into voxels", 0.5);
    tbb::parallel_sort(bins.entries.begin(), bins.entries.end());

    for (std::size_t i = 1; i <= bins.entries.size(); ++i) {
        if (i == bins.entries.size() || bins.entries[i].leaf != bins.entries[i - 1].leaf) bins.offsets.push_back(i);
    }
    report_progress(progress, "sort cells into voxels", 1);
    return bins;
}

}  // namespace subvol
