// Cells into voxels, in vectors as wide as the machine has them. This file is compiled once for every instruction set, and the
// best one is chosen where it runs.
#include "fill_block.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <tuple>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fill_block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fill_rows-inl.h"
#include "fill_values-inl.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

/// Fills the voxels of `box`, which lies in the brick, whose centres lie in a cell.
HWY_ATTR void fill_cell(const CellShape& shape, const VoxelBox& box, const FillOptions& options, VoxelBrick& brick) {
    const TetPlanes planes(shape);
    if (planes.has_turned(options.orientation)) brick.doubtful.push_back(box);
    ValueFiller filler(shape, options);
    FoundVoxels found;
    const VoxelCoord lower{box.lower[0] - brick.origin[0], box.lower[1] - brick.origin[1], box.lower[2] - brick.origin[2]};
    const VoxelCoord upper{box.upper[0] - brick.origin[0], box.upper[1] - brick.origin[1], box.upper[2] - brick.origin[2]};
    for (int lz = lower[2] / kLeafSide; lz <= upper[2] / kLeafSide; ++lz) {
        const int z0 = lz * kLeafSide;
        HWY_ALIGN double z[kLeafSide], z_shifted[kLeafSide];
        for (int i = 0; i < kLeafSide; ++i) {
            const double index = brick.origin[2] + z0 + i;
            z[i] = index - shape.origin.z;
            z_shifted[i] = (index + kCentreStep.z) - shape.origin.z;
        }
        const std::uint64_t reach =
            (std::uint64_t{2} << std::min(upper[2] - z0, kLeafSide - 1)) - (std::uint64_t{1} << std::max(lower[2] - z0, 0));
        for (int ix = lower[0]; ix <= upper[0]; ++ix) {
            const double x = brick.origin[0] + ix;
            for (int iy = lower[1]; iy <= upper[1]; ++iy) {
                const auto slot =
                    static_cast<std::size_t>((ix / kLeafSide * kBrickLeaves + iy / kLeafSide) * kBrickLeaves + lz);
                auto& leaf = brick.leaves[slot];
                const auto word = static_cast<std::size_t>(ix % kLeafSide);
                const int shift = iy % kLeafSide * kLeafSide;
                const std::uint64_t open = leaf ? reach & ~(leaf->active[word] >> shift) : reach;
                if (open == 0) continue;
                const double y = brick.origin[1] + iy;
                std::uint64_t inside =
                    open & planes.inside((x + kCentreStep.x) - shape.origin.x, (y + kCentreStep.y) - shape.origin.y, z_shifted);
                if (inside == 0) continue;
                if (!leaf) leaf = std::make_unique<VoxelLeaf>(options.leaf_channels());
                leaf->active[word] |= inside << shift;
                if (options.leaf_channels() == 0) continue;
                float* row = leaf->values.get() + 64 * word + static_cast<std::size_t>(shift);
                if (found.count + kLeafSide > FoundVoxels::kMost) filler.fill(found);
                for (; inside != 0; inside &= inside - 1) {
                    const auto i = static_cast<std::size_t>(std::countr_zero(inside));
                    found.places[0][found.count] = x - shape.origin.x;
                    found.places[1][found.count] = y - shape.origin.y;
                    found.places[2][found.count] = z[i];
                    found.values[found.count++] = row + i;
                }
            }
        }
    }
    filler.fill(found);
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(fill_cell);

namespace {

constexpr double kGenerosity = 3e-6;  // voxels; above the shift of centres on a face and the rounding at 2³⁰

VoxelBox voxels_between(const Vec3& lower, const Vec3& upper) {
    VoxelBox box;
    for (int d = 0; d < 3; ++d) {
        const auto i = static_cast<std::size_t>(d);
        box.lower[i] = static_cast<int>(std::ceil(lower[d] - kGenerosity));
        box.upper[i] = static_cast<int>(std::floor(upper[d] + kGenerosity));
    }
    return box;
}

/// Corners of the cell at node (i, j, k) of a block, in VTK order.
std::array<std::size_t, 8> corner_nodes(std::size_t lowest, std::size_t side) {
    const std::size_t v = side, w = side * side;
    return {lowest, lowest + 1, lowest + v + 1, lowest + v, lowest + w, lowest + w + 1, lowest + w + v + 1, lowest + w + v};
}

const CornerSplit& split_of(const CellBlock& block, const std::array<std::size_t, 8>& nodes) {
    if (block.ids) {
        return corner_split([&](std::size_t a, std::size_t b) { return block.ids[nodes[a]] < block.ids[nodes[b]]; });
    }
    return corner_split([&](std::size_t a, std::size_t b) {
        const Vec3 &p = block.points[nodes[a]], &q = block.points[nodes[b]];
        return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
    });
}

void set_shape(const CellBlock& block, const std::array<std::size_t, 8>& nodes, std::size_t channels, CellShape& shape) {
    shape.cell = block.cell;
    shape.origin = block.points[nodes[0]];
    shape.split = &split_of(block, nodes);
    shape.values.resize(8 * channels);
    for (std::size_t k = 0; k < 8; ++k) {
        const Vec3 p = block.points[nodes[k]] - shape.origin;
        for (std::size_t d = 0; d < 3; ++d) shape.corners[d][k] = p[static_cast<int>(d)];
        for (std::size_t c = 0; c < channels; ++c) shape.values[8 * c + k] = block.values[nodes[k] * channels + c];
    }
}

}  // namespace

VoxelBox voxels_of(const CellBlock& block) {
    Box box;
    for (std::size_t n = 0; n < block.side * block.side * block.side; ++n) box.add(block.points[n]);
    return voxels_between(box.lower, box.upper);
}

void fill_block(const CellBlock& block, const FillOptions& options, VoxelBrick& brick) {
    const auto fill_cell_here = HWY_DYNAMIC_DISPATCH(fill_cell);
    const VoxelBox within = brick.box();
    CellShape shape;
    for (std::size_t w = 0; w + 1 < block.side; ++w) {
        for (std::size_t v = 0; v + 1 < block.side; ++v) {
            for (std::size_t u = 0; u + 1 < block.side; ++u) {
                const auto nodes = corner_nodes((w * block.side + v) * block.side + u, block.side);
                Box box;
                for (const std::size_t n : nodes) box.add(block.points[n]);
                const VoxelBox voxels = common(voxels_between(box.lower, box.upper), within);
                if (voxels.empty()) continue;
                set_shape(block, nodes, options.channels, shape);
                fill_cell_here(shape, voxels, options, brick);
            }
        }
    }
}

std::array<double, 8> linear_weights(const CellShape& shape, const Vec3& x) {
    const auto corner = [&](std::size_t t, std::size_t k) {
        const auto c = static_cast<std::size_t>(shape.split->corners[k][t]);
        return Vec3(shape.corners[0][c], shape.corners[1][c], shape.corners[2][c]);
    };
    double best = -HUGE_VAL;
    std::array<double, 8> weights{};
    weights[0] = 1;
    for (std::size_t t = 0; t < 6; ++t) {
        const Vec3 first = corner(t, 0), a = corner(t, 1) - first, b = corner(t, 2) - first, c = corner(t, 3) - first;
        const double determinant = glm::dot(a, glm::cross(b, c));
        const Vec3 p = x - first;
        const double l1 = glm::dot(p, glm::cross(b, c)) / determinant, l2 = glm::dot(p, glm::cross(c, a)) / determinant;
        const double l3 = glm::dot(p, glm::cross(a, b)) / determinant;
        const std::array<double, 4> lambda{1 - l1 - l2 - l3, l1, l2, l3};
        const double lowest = std::min({lambda[0], lambda[1], lambda[2], lambda[3]});
        if (!(lowest > best)) continue;
        best = lowest;
        weights = {};
        for (std::size_t k = 0; k < 4; ++k) weights[static_cast<std::size_t>(shape.split->corners[k][t])] += lambda[k];
    }
    return weights;
}

}  // namespace subvol::detail
#endif
