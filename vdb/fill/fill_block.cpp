// SPDX-License-Identifier: Apache-2.0
// Cells into voxels, in the widest vectors of the machine. This file is compiled once for every instruction set; the best one
// is chosen at run time. The parts that hold no vectors are compiled once.
//
//     straight cell   split into six tetrahedra ─► for rows of centres, one a lane, a word of bits: which centres lie inside
//                     ─► voxels that are not active yet become active ─► their values, up to 64 at a time
//     curved piece    box of its Bézier control points ─► Newton's method at centres ─► inside if parameters are within bounds;
//                     a piece that is refused is split into eight small cells, and the rest is filled by its parameters
//
// Bounds are [0,1] on the boundary and a little more on other sides, so that no centre between two neighbours is missed. Boxes
// are widened by more than the step by which centres are moved and the rounding. A box with turned tetrahedra is noted as
// doubtful.
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

#include "fill_curved-inl.h"
#include "fill_rows-inl.h"
#include "fill_values-inl.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

/// Fills the voxels of a brick whose centres lie in a cell.
class CellFiller {
public:
    CellFiller(const CellShape& shape, const CellBlock& block, VoxelBrick& brick)
        : shape_(shape), block_(block), brick_(brick) {}

    /// box: the voxels to test, inside the brick. One row along z per lane.
    HWY_ATTR void run(const VoxelBox& box) {
        const Lanes d;
        const TetPlanes planes(shape_, Vec3(box.lower[0], box.lower[1], box.lower[2]) + kCentreStep - shape_.origin);
        if (planes.has_turned(block_.orientation)) brick_.doubtful.push_back(box);
        const int along_y = box.upper[1] - box.lower[1] + 1, along_z = box.upper[2] - box.lower[2] + 1;
        const int rows = (box.upper[0] - box.lower[0] + 1) * along_y;
        for (int row = 0; row < rows; row += static_cast<int>(kLanes)) {
            const auto numbers = hn::Iota(d, row);
            const auto x = hn::Floor(hn::Mul(hn::Add(numbers, hn::Set(d, 0.5)), hn::Set(d, 1.0 / along_y)));
            const auto y = hn::NegMulAdd(x, hn::Set(d, along_y), numbers);
            HWY_ALIGN std::uint64_t inside[kLanes];
            hn::Store(planes.inside(x, y, along_z), BitLanes(), inside);
            const int end = std::min(rows, row + static_cast<int>(kLanes));
            for (int r = row; r < end; ++r) {
                const std::uint64_t bits = inside[r - row];
                if (bits != 0) fill_row({box.lower[0] + r / along_y, box.lower[1] + r % along_y, box.lower[2]}, bits);
            }
        }
        fill_values();
    }

private:
    /// inside: bit i is voxel i of the row
    HWY_ATTR void fill_row(const VoxelCoord& first, std::uint64_t inside) {
        const auto [x, y, z] =
            VoxelCoord{first[0] - brick_.origin[0], first[1] - brick_.origin[1], first[2] - brick_.origin[2]};
        const auto leaf_column = static_cast<std::size_t>((x / kLeafSide * kBrickLeaves + y / kLeafSide) * kBrickLeaves);
        const auto word = static_cast<std::size_t>(x % kLeafSide), shift = static_cast<std::size_t>(y % kLeafSide * kLeafSide);
        inside <<= z;
        for (std::size_t l = leaf_column; inside != 0; ++l, inside >>= kLeafSide) {
            std::uint64_t bits = inside & 0xff;
            if (bits == 0) continue;
            auto& leaf = brick_.leaves[l];
            if (!leaf) leaf = std::make_unique<VoxelLeaf>(block_.leaf_channels());
            bits &= ~(leaf->active[word] >> shift);
            leaf->active[word] |= bits << shift;
            if (block_.leaf_channels() == 0) continue;
            if (found_.count + kLeafSide > FoundVoxels::kMost) fill_values();
            float* values = leaf->values.get() + kLeafVoxels / kLeafSide * word + shift;
            const double z0 = brick_.origin[2] + static_cast<int>(l - leaf_column) * kLeafSide;
            for (; bits != 0; bits &= bits - 1) {
                const int i = std::countr_zero(bits);
                found_.places[0][found_.count] = first[0] - shape_.origin.x;
                found_.places[1][found_.count] = first[1] - shape_.origin.y;
                found_.places[2][found_.count] = (z0 + i) - shape_.origin.z;
                found_.values[found_.count++] = values + i;
            }
        }
    }

    HWY_ATTR void fill_values() {
        if (found_.count == 0) return;
        if (shape_.curved) {
            ValueFiller<Triquadratic>(shape_, block_).fill(found_);
        } else {
            ValueFiller<Trilinear>(shape_, block_).fill(found_);
        }
    }

    const CellShape& shape_;
    const CellBlock& block_;
    VoxelBrick& brick_;
    FoundVoxels found_;
};

/// Fills the voxels of `box`, which lies in the brick, whose centres lie in a cell.
HWY_ATTR void fill_cell(const CellShape& shape, const VoxelBox& box, const CellBlock& block, VoxelBrick& brick) {
    CellFiller(shape, block, brick).run(box);
}

/// The same for a curved piece; false if it is to be split into small cells.
HWY_ATTR bool fill_piece(const CellShape& shape, const PieceBounds& bounds, const VoxelBox& box, const CellBlock& block,
                         VoxelBrick& brick) {
    return CurvedFiller(shape, bounds, block, brick).run(box);
}

/// After the small cells of such a piece.
HWY_ATTR void fill_rest_of_piece(const CellShape& shape, const PieceBounds& bounds, const VoxelBox& box, const CellBlock& block,
                                 VoxelBrick& brick) {
    CurvedFiller(shape, bounds, block, brick).run_on_rest(box);
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

namespace {

using AwayFaces = std::array<std::array<std::array<std::size_t, 4>, 3>, 8>;

AwayFaces make_away_faces() {
    AwayFaces away;
    for (std::size_t corner = 0; corner < 8; ++corner) {
        std::size_t count = 0;
        for (const auto& face : kCellFaces) {
            if (std::ranges::find(face, corner) == face.end()) away[corner][count++] = face;
        }
    }
    return away;
}

CornerSplit make_split(std::size_t apex, std::size_t diagonals) {
    CornerSplit split;
    for (std::size_t t = 0; t < 8; ++t) {
        const std::size_t f = std::min(t, std::size_t{5}) / 2, half = std::min(t, std::size_t{5}) % 2;
        auto quad = faces_away_from(apex)[f];
        std::rotate(quad.begin(), quad.begin() + static_cast<int>(diagonals >> f & 1), quad.end());
        // As in `split_cell`: the quad is counter-clockwise from outside and the apex lies behind it.
        const std::array corners{quad[0], half == 0 ? quad[2] : quad[3], half == 0 ? quad[1] : quad[2], apex};
        for (std::size_t k = 0; k < 4; ++k) split.corners[k][t] = static_cast<std::int64_t>(corners[k]);
    }
    return split;
}

std::array<CornerSplit, 64> make_splits() {
    std::array<CornerSplit, 64> splits;
    for (std::size_t i = 0; i < splits.size(); ++i) splits[i] = make_split(i / 8, i % 8);
    return splits;
}

}  // namespace

const std::array<std::array<std::size_t, 4>, 3>& faces_away_from(std::size_t corner) {
    static const AwayFaces kAway = make_away_faces();
    return kAway[corner];
}

const CornerSplit& corner_split(std::size_t apex, std::size_t diagonals) {
    static const std::array<CornerSplit, 64> kSplits = make_splits();
    return kSplits[8 * apex + diagonals];
}

HWY_EXPORT(fill_cell);
HWY_EXPORT(fill_piece);
HWY_EXPORT(fill_rest_of_piece);

namespace {

constexpr double kMostSlack = 0.2;  // parameters
constexpr double kMargin = 3e-6;    // voxels; larger than kCentreStep and the rounding at 2³⁰

VoxelBox voxels_between(const Vec3& lower, const Vec3& upper) {
    VoxelBox box;
    for (int d = 0; d < 3; ++d) {
        const auto i = static_cast<std::size_t>(d);
        box.lower[i] = static_cast<int>(std::ceil(lower[d] - kMargin));
        box.upper[i] = static_cast<int>(std::floor(upper[d] + kMargin));
    }
    return box;
}

/// The corners, in VTK order, of the cell of step³ smaller ones whose first corner is node `lowest` of a block.
std::array<std::size_t, 8> corner_nodes(std::size_t lowest, std::size_t step, const CellBlock& block) {
    const std::size_t u = step, v = u * block.side, w = v * block.side;
    return {lowest, lowest + u, lowest + v + u, lowest + v, lowest + w, lowest + w + u, lowest + w + v + u, lowest + w + v};
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

/// Finds the 27 nodes of the curved piece that contains the cell at `lowest`, the piece itself or one of its eight small cells.
void set_nodes(const CellBlock& block, std::size_t lowest, std::size_t step, CellShape& shape) {
    const std::size_t channels = block.channels;
    constexpr std::size_t across = 2;
    shape.part = static_cast<double>(step) / static_cast<double>(across);
    std::size_t first = lowest, stride = 1;
    for (double& at : shape.first_part) {
        const std::size_t inside = lowest / stride % block.side % across;
        at = static_cast<double>(inside) / static_cast<double>(across);
        first -= inside * stride;
        stride *= block.side;
    }
    shape.node_values.resize(kCurvedNodes * channels);
    for (std::size_t n = 0; n < kCurvedNodes; ++n) {
        const std::size_t node = first + across / 2 * (n % 3 + block.side * (n / 3 % 3 + block.side * (n / 9)));
        const Vec3 p = block.points[node] - shape.origin;
        for (std::size_t d = 0; d < 3; ++d) shape.nodes[d][n] = p[static_cast<int>(d)];
        for (std::size_t c = 0; c < channels; ++c) {
            shape.node_values[kCurvedNodes * c + n] = block.values[node * channels + c];
        }
    }
    for (auto& along : shape.nodes) std::fill(along.begin() + kCurvedNodes, along.end(), along[kCurvedNodes - 1]);
}

/// A piece or small cell, but for what only its tetrahedra need.
void set_places(const CellBlock& block, const std::array<std::size_t, 8>& nodes, std::size_t step, CellShape& shape) {
    shape.origin = block.points[nodes[0]];
    Box box;
    for (std::size_t k = 0; k < 8; ++k) {
        const Vec3& at = block.points[nodes[k]];
        box.add(at);
        const Vec3 p = at - shape.origin;
        for (std::size_t d = 0; d < 3; ++d) shape.corners[d][k] = p[static_cast<int>(d)];
    }
    shape.size = std::max({box.size().x, box.size().y, box.size().z});
    shape.curved = block.curved;
    if (block.curved) set_nodes(block, nodes[0], step, shape);
}

void set_shape(const CellBlock& block, const std::array<std::size_t, 8>& nodes, std::size_t step, CellShape& shape) {
    const std::size_t channels = block.channels;
    set_places(block, nodes, step, shape);
    shape.split = &split_of(block, nodes);
    shape.values.resize(8 * channels);
    for (std::size_t k = 0; k < 8; ++k) {
        for (std::size_t c = 0; c < channels; ++c) shape.values[8 * c + k] = block.values[nodes[k] * channels + c];
    }
}

/// Calls visit with the lowest node of every cell of step³ smaller ones.
template <class Visit>
void for_each_cell(const CellBlock& block, std::size_t step, const Visit& visit) {
    for (std::size_t w = 0; w + 1 < block.side; w += step) {
        for (std::size_t v = 0; v + 1 < block.side; v += step) {
            for (std::size_t u = 0; u + 1 < block.side; u += step) visit((w * block.side + v) * block.side + u);
        }
    }
}

/// A box about a curved piece: about the control points of its Bézier form, whose middle ones are 2m − (a + b)/2.
Box hull_of(const CellBlock& block, std::size_t lowest) {
    std::array<Vec3, kCurvedNodes> p;
    for (std::size_t n = 0; n < kCurvedNodes; ++n) {
        p[n] = block.points[lowest + n % 3 + block.side * (n / 3 % 3 + block.side * (n / 9))];
    }
    for (const std::size_t stride : {1, 3, 9}) {
        for (std::size_t outer = stride; outer < kCurvedNodes; outer += 3 * stride) {  // middle nodes along the axis
            for (std::size_t n = outer; n < outer + stride; ++n) p[n] = 2.0 * p[n] - 0.5 * (p[n - stride] + p[n + stride]);
        }
    }
    Box box;
    for (const Vec3& x : p) box.add(x);
    return box;
}

/// Which parameters a piece contains.
PieceBounds bounds_of(const CellBlock& block, std::size_t lowest) {
    PieceBounds bounds;
    std::size_t stride = 1;
    for (std::size_t d = 0; d < 3; ++d, stride *= block.side) {
        const std::size_t at = lowest / stride % block.side;
        // Its length along the axis, through its middle.
        const std::size_t middle = lowest + 1 + block.side * (1 + block.side);
        const double length = glm::length(block.points[middle + stride] - block.points[middle - stride]);
        const double slack = std::min(kMostSlack, length > 0 ? block.slack / length : 0.0);
        const bool on_lower = at == 0 && (block.boundary >> (2 * d) & 1) != 0;
        const bool on_upper = at + 3 == block.side && (block.boundary >> (2 * d + 1) & 1) != 0;
        bounds.lower[d] = on_lower ? 0 : -slack;
        bounds.upper[d] = on_upper ? 1 : 1 + slack;
    }
    return bounds;
}

void fill_small_cell(const CellBlock& block, std::size_t lowest, std::size_t step, const VoxelBox& within, CellShape& shape,
                     VoxelBrick& brick) {
    const auto nodes = corner_nodes(lowest, step, block);
    Box box;
    for (const std::size_t n : nodes) box.add(block.points[n]);
    const VoxelBox voxels = common(voxels_between(box.lower, box.upper), within);
    if (voxels.empty()) return;
    set_shape(block, nodes, step, shape);
    HWY_DYNAMIC_DISPATCH(fill_cell)(shape, voxels, block, brick);
}

}  // namespace

void set_piece_boxes(const CellBlock& block, VoxelBox* boxes) {
    for_each_cell(block, 2, [&](std::size_t lowest) {
        const Box hull = hull_of(block, lowest);
        *boxes++ = voxels_between(hull.lower - Vec3(block.slack), hull.upper + Vec3(block.slack));
    });
}

VoxelBox voxels_of(const CellBlock& block) {
    if (!block.curved) {
        Box box;
        for (std::size_t n = 0; n < block.side * block.side * block.side; ++n) box.add(block.points[n]);
        return voxels_between(box.lower, box.upper);
    }
    VoxelBox all = block.piece_boxes[0];
    for (std::size_t i = 1; i < block.pieces(); ++i) {
        for (std::size_t d = 0; d < 3; ++d) {
            all.lower[d] = std::min(all.lower[d], block.piece_boxes[i].lower[d]);
            all.upper[d] = std::max(all.upper[d], block.piece_boxes[i].upper[d]);
        }
    }
    return all;
}

void fill_block(const CellBlock& block, CellShape& shape, VoxelBrick& brick) {
    const VoxelBox within = brick.box();
    if (!block.curved) {
        for_each_cell(block, block.step,
                      [&](std::size_t lowest) { fill_small_cell(block, lowest, block.step, within, shape, brick); });
        return;
    }
    const auto fill_piece_here = HWY_DYNAMIC_DISPATCH(fill_piece);
    const VoxelBox* piece = block.piece_boxes;
    for_each_cell(block, 2, [&](std::size_t lowest) {
        const VoxelBox voxels = common(*piece++, within);
        if (voxels.empty()) return;
        const auto nodes = corner_nodes(lowest, 2, block);
        set_places(block, nodes, 2, shape);
        const PieceBounds bounds = bounds_of(block, lowest);
        if (fill_piece_here(shape, bounds, voxels, block, brick)) return;
        const std::size_t doubtful = brick.doubtful.size();
        for (std::size_t k = 0; k < 8; ++k) {
            const std::size_t part = lowest + (k & 1) + block.side * ((k >> 1 & 1) + block.side * (k >> 2));
            fill_small_cell(block, part, 1, within, shape, brick);
        }
        if (brick.doubtful.size() > doubtful) brick.doubtful.push_back(voxels);
        set_places(block, nodes, 2, shape);
        HWY_DYNAMIC_DISPATCH(fill_rest_of_piece)(shape, bounds, voxels, block, brick);
    });
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
