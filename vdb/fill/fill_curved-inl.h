// SPDX-License-Identifier: Apache-2.0
// Centres in a curved piece, with their values. Included once for every instruction set: see fill_block.cpp.
//
// A piece maps parameters u = (u, v, w) to space, x(u) = Σ Nᵢ(u) xᵢ over 27 nodes. It contains a centre p if the u with x(u) =
// p, which the value needs anyway, lies within its bounds. What is left to do is to ask few centres in vain:
//
//      ________         The linear map of the piece's middle predicts u from p, but for the bend of the piece: in no node, and
//     /     . /         so nowhere, is it wrong by more than a margin. Along a row of centres each predicted parameter is
//    / o  o  o          linear, so the centres that may lie inside are one interval of the row.
#if defined(SUBVOL_FILL_CURVED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_FILL_CURVED_INL_H
#undef SUBVOL_FILL_CURVED_INL_H
#else
#define SUBVOL_FILL_CURVED_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "fill_block.h"
#include "fill_rows-inl.h"
#include "fill_values-inl.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

constexpr double kLeastDeterminant = 1e-3;  // relative to the largest: below, the piece is as good as flat there
constexpr double kMostBend = 0.3;           // in parameters: beyond, Newton's method may miss
constexpr double kBetweenNodes = 2;         // a triquadratic function exceeds its nodes' range about 0 by less: 1.25³

/// The parameters of the nodes, the last one repeated.
struct NodeParameters {
    alignas(64) double at[3][kPaddedNodes];
    constexpr NodeParameters() : at{} {
        for (std::size_t n = 0; n < kPaddedNodes; ++n) {
            const std::size_t node = n < kCurvedNodes ? n : kCurvedNodes - 1;
            at[0][n] = 0.5 * static_cast<double>(node % 3);
            at[1][n] = 0.5 * static_cast<double>(node / 3 % 3);
            at[2][n] = 0.5 * static_cast<double>(node / 9);
        }
    }
};
inline constexpr NodeParameters kNodes;

/// For rows of centres along z, those that may lie inside a piece: between two planes for each parameter.
class RowIntervals {
public:
    RowIntervals(const MiddleOfCell& middle, const PieceBounds& bounds, const std::array<double, 3>& margins,
                 const Vec3& origin, const VoxelBox& box)
        : lowest_(box.lower[2]), highest_(box.upper[2]) {
        const Vec3 start = Vec3(box.lower[0], box.lower[1], 0) + kCentreStep - origin;
        for (std::size_t a = 0; a < 3; ++a) {
            const auto [at, slope] = middle.along_z(a, start);
            const double along_x = middle.slope(a, 0), along_y = middle.slope(a, 1);
            const double low = bounds.lower[a] - margins[a] - at, high = bounds.upper[a] + margins[a] - at;
            Planes& p = planes_[a];
            p.is_level = std::abs(slope) * kBrickSide < 1e-9;  // the parameter does not change along a row
            if (p.is_level) {
                p = {low - slope * lowest_ - 1e-9, high - slope * lowest_ + 1e-9, -along_x, -along_y, true};
            } else {
                const double inverse = 1 / slope;
                p = {(slope > 0 ? low : high) * inverse, (slope > 0 ? high : low) * inverse, -along_x * inverse,
                     -along_y * inverse, false};
            }
        }
    }

    /// x, y: of the rows, from the first one. Returns false if all intervals are empty.
    HWY_ATTR bool find(Doubles x, Doubles y, double* first, double* last) const {
        const Lanes d;
        auto from = hn::Set(d, lowest_), to = hn::Set(d, highest_);
        for (const Planes& p : planes_) {
            const auto moved = hn::MulAdd(hn::Set(d, p.along_x), x, hn::Mul(hn::Set(d, p.along_y), y));
            const auto low = hn::Add(hn::Set(d, p.low), moved), high = hn::Add(hn::Set(d, p.high), moved);
            if (p.is_level) {
                const auto outside = hn::Or(hn::Gt(low, hn::Zero(d)), hn::Lt(high, hn::Zero(d)));
                to = hn::IfThenElse(outside, hn::Set(d, lowest_ - 1), to);
            } else {
                from = hn::Max(from, low);
                to = hn::Min(to, high);
            }
        }
        from = hn::Ceil(from);
        to = hn::Floor(to);
        hn::Store(from, d, first);
        hn::Store(to, d, last);
        return !hn::AllFalse(d, hn::Le(from, to));
    }

private:
    struct Planes {
        double low, high, along_x, along_y;
        bool is_level;
    };
    std::array<Planes, 3> planes_;
    double lowest_, highest_;
};

class CurvedFiller {
public:
    HWY_ATTR CurvedFiller(const CellShape& shape, const PieceBounds& bounds, const CellBlock& block, VoxelBrick& brick)
        : shape_(shape), bounds_(bounds), block_(block), brick_(brick), values_(shape, block) {}

    /// box:     the voxels to test, inside the brick
    /// returns: false, and fills nothing, if the piece is folded, flat or too much bent
    HWY_ATTR bool run(const VoxelBox& box) {
        if (!set_margins()) return false;
        fill(box);
        return true;
    }

    /// The voxels that the small cells of such a piece have left out, as far as Newton's method finds them: between their flat
    /// faces and the curved sides of its neighbours.
    HWY_ATTR void run_on_rest(const VoxelBox& box) {
        margins_.fill(HUGE_VAL);
        fill(box);
    }

private:
    /// One row along z per lane.
    HWY_ATTR void fill(const VoxelBox& box) {
        const Lanes d;
        const RowIntervals intervals(values_.middle(), bounds_, margins_, shape_.origin, box);
        const int along_y = box.upper[1] - box.lower[1] + 1;
        const int rows = (box.upper[0] - box.lower[0] + 1) * along_y;
        for (int row = 0; row < rows; row += static_cast<int>(kLanes)) {
            const auto numbers = hn::Iota(d, row);
            const auto x = hn::Floor(hn::Mul(hn::Add(numbers, hn::Set(d, 0.5)), hn::Set(d, 1.0 / along_y)));
            const auto y = hn::NegMulAdd(x, hn::Set(d, along_y), numbers);
            HWY_ALIGN double first[kLanes], last[kLanes];
            if (!intervals.find(x, y, first, last)) continue;
            const int end = std::min(rows, row + static_cast<int>(kLanes));
            for (int r = row; r < end; ++r) {
                const auto lane = static_cast<std::size_t>(r - row);
                if (!(first[lane] <= last[lane])) continue;
                add_row({box.lower[0] + r / along_y, box.lower[1] + r % along_y, static_cast<int>(first[lane])},
                        static_cast<int>(last[lane]));
            }
        }
        flush();
    }

    /// Where the map has the same orientation at all nodes, how far the linear map is from the parameters of the nodes.
    HWY_ATTR bool set_margins() {
        const Lanes d;
        auto least = hn::Inf(d);
        auto most = hn::Zero(d), bend_u = most, bend_v = most, bend_w = most;
        for (std::size_t n = 0; n < kPaddedNodes; n += kLanes) {
            const Parameters q{hn::Load(d, &kNodes.at[0][n]), hn::Load(d, &kNodes.at[1][n]), hn::Load(d, &kNodes.at[2][n])};
            const auto zero = hn::Zero(d);
            const Residual rx = residual(values_.map()[0], q, zero), ry = residual(values_.map()[1], q, zero);
            const Residual rz = residual(values_.map()[2], q, zero);
            const auto ax = hn::MulSub(ry.dv, rz.dw, hn::Mul(ry.dw, rz.dv));
            const auto ay = hn::MulSub(rz.dv, rx.dw, hn::Mul(rz.dw, rx.dv));
            const auto az = hn::MulSub(rx.dv, ry.dw, hn::Mul(rx.dw, ry.dv));
            const auto determinant =
                hn::Mul(hn::Set(d, block_.orientation), hn::MulAdd(rx.du, ax, hn::MulAdd(ry.du, ay, hn::Mul(rz.du, az))));
            least = hn::Min(least, determinant);
            most = hn::Max(most, determinant);
            const Parameters p = values_.middle().parameters(hn::Load(d, &shape_.nodes[0][n]), hn::Load(d, &shape_.nodes[1][n]),
                                                             hn::Load(d, &shape_.nodes[2][n]));
            bend_u = hn::Max(bend_u, hn::Abs(hn::Sub(p.u, q.u)));
            bend_v = hn::Max(bend_v, hn::Abs(hn::Sub(p.v, q.v)));
            bend_w = hn::Max(bend_w, hn::Abs(hn::Sub(p.w, q.w)));
        }
        const double lowest = hn::GetLane(hn::MinOfLanes(d, least)), highest = hn::GetLane(hn::MaxOfLanes(d, most));
        margins_ = {hn::GetLane(hn::MaxOfLanes(d, bend_u)), hn::GetLane(hn::MaxOfLanes(d, bend_v)),
                    hn::GetLane(hn::MaxOfLanes(d, bend_w))};
        const bool plain = lowest > kLeastDeterminant * highest &&
                           std::max({margins_[0], margins_[1], margins_[2]}) < kMostBend;  // false for NaN
        for (double& margin : margins_) margin = kBetweenNodes * margin + 1e-6;
        return plain;
    }

    /// The inactive voxels of a row are candidates.
    HWY_ATTR void add_row(const VoxelCoord& first, int last) {
        const VoxelCoord at{first[0] - brick_.origin[0], first[1] - brick_.origin[1], first[2] - brick_.origin[2]};
        const auto column = static_cast<std::size_t>((at[0] / kLeafSide * kBrickLeaves + at[1] / kLeafSide) * kBrickLeaves);
        const auto word = static_cast<std::size_t>(at[0] % kLeafSide),
                   shift = static_cast<std::size_t>(at[1] % kLeafSide * kLeafSide);
        const int end = last - brick_.origin[2];
        for (int z = at[2]; z <= end;) {
            const int leaf_end = std::min(end, z | (kLeafSide - 1));
            const std::size_t l = column + static_cast<std::size_t>(z / kLeafSide);
            std::uint64_t bits = ((std::uint64_t{2} << leaf_end % kLeafSide) - 1) & ~((std::uint64_t{1} << z % kLeafSide) - 1);
            if (const auto& leaf = brick_.leaves[l]) bits &= ~(leaf->active[word] >> shift);
            for (bits &= 0xff; bits != 0; bits &= bits - 1) {
                if (found_.count == FoundVoxels::kMost) flush();
                const auto bit = static_cast<std::size_t>(std::countr_zero(bits));
                found_.places[0][found_.count] = first[0] + kCentreStep.x - shape_.origin.x;
                found_.places[1][found_.count] = first[1] + kCentreStep.y - shape_.origin.y;
                found_.places[2][found_.count] =
                    brick_.origin[2] + z / kLeafSide * kLeafSide + static_cast<int>(bit) + kCentreStep.z - shape_.origin.z;
                slots_[found_.count++] = {l, word, shift + bit};
            }
            z = leaf_end + 1;
        }
    }

    /// Finds the parameters of all candidates, and fills the voxels of those within the bounds.
    HWY_ATTR void flush() {
        const Lanes d;
        for (std::size_t i = found_.count; i % kLanes != 0; ++i) {
            for (auto& along : found_.places) along[i] = along[found_.count - 1];
        }
        Parameters q[ValueFiller<Triquadratic>::kVectors] = {};
        bool any = false;
        for (std::size_t first = 0, v = 0; first < found_.count; first += kLanes, ++v) {
            const auto good = values_.find(found_, first, q[v]);
            const auto within = [&](Doubles u, std::size_t a) HWY_ATTR {
                return hn::And(hn::Ge(u, hn::Set(d, bounds_.lower[a])), hn::Le(u, hn::Set(d, bounds_.upper[a])));
            };
            std::uint8_t bits[8] = {};
            hn::StoreMaskBits(d, hn::And(hn::And(good, within(q[v].u, 0)), hn::And(within(q[v].v, 1), within(q[v].w, 2))),
                              bits);
            const std::size_t count = std::min(kLanes, found_.count - first);
            for (std::size_t i = 0; i < count; ++i) {
                float*& value = found_.values[first + i];
                value = nullptr;
                if ((bits[0] >> i & 1) == 0) continue;
                const auto [l, word, bit] = slots_[first + i];
                auto& leaf = brick_.leaves[l];
                if (!leaf) leaf = std::make_unique<VoxelLeaf>(block_.leaf_channels());
                leaf->active[word] |= std::uint64_t{1} << bit;
                if (block_.leaf_channels() == 0) continue;
                value = leaf->values.get() + kLeafVoxels / kLeafSide * word + bit;
                any = true;
            }
        }
        if (any) values_.store(found_, q);
        found_.count = 0;
    }

    struct Slot {
        std::size_t leaf, word, bit;
    };

    const CellShape& shape_;
    const PieceBounds& bounds_;
    const CellBlock& block_;
    VoxelBrick& brick_;
    ValueFiller<Triquadratic> values_;
    std::array<double, 3> margins_{};
    FoundVoxels found_;
    std::array<Slot, FoundVoxels::kMost> slots_;
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
