// SPDX-License-Identifier: Apache-2.0
#include "segment_rules.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cell_parts.h"
#include "edge_window.h"
#include "fold_test.h"
#include "kept.h"
#include "moving_part.h"

namespace subvol::detail {

namespace {

template <class Part>
bool is_proved(const Part& part, double error, int levels) {
    const PartDecision decision = decide(part, error);
    if (decision.verdict != PartVerdict::Undecided) return decision.verdict == PartVerdict::Proved;
    if (levels == 0) return false;
    return std::ranges::all_of(part.children(), [&](const Part& child) { return is_proved(child, error, levels - 1); });
}

std::vector<Vec3> points_of(const Eigen::MatrixXd& rows) {
    std::vector<Vec3> points;
    for (Eigen::Index k = 0; k < rows.rows(); ++k) points.emplace_back(rows(k, 0), rows(k, 1), rows(k, 2));
    return points;
}

// points: of all pieces
BezierPoints bezier_points(const Eigen::MatrixXd& points, const std::array<Eigen::Index, 64>& piece) {
    BezierPoints bezier;
    for (std::size_t c = 0; c < 3; ++c) {
        const double* const column = points.data() + static_cast<Eigen::Index>(c) * points.rows();
        for (std::size_t p = 0; p < 64; ++p) bezier[c][p] = column[piece[p]];
    }
    make_bezier(bezier);
    return bezier;
}

// Coefficients of the derivative along an axis: places of one coordinate.
template <std::size_t kStride>
std::array<double, 48> slopes_along_axis(const std::array<double, 64>& values) {
    std::array<double, 48> slopes;
    for (std::size_t block = 0, to = 0; block < 64; block += 4 * kStride) {
        for (std::size_t n = block; n < block + 3 * kStride; ++n, ++to) slopes[to] = 3 * (values[n + kStride] - values[n]);
    }
    return slopes;
}

// The first test of `decide` alone, for pieces that do not move, without a part being made.
bool passes_norm(const BezierPoints& bezier, double error) {
    using Slopes = std::array<std::array<double, 48>, 3>;  // of each coordinate
    std::array<Slopes, 3> slopes;
    for (std::size_t c = 0; c < 3; ++c) {
        slopes[0][c] = slopes_along_axis<16>(bezier[c]);
        slopes[1][c] = slopes_along_axis<4>(bezier[c]);
        slopes[2][c] = slopes_along_axis<1>(bezier[c]);
    }
    // Any matrix will do as G; this one is near the derivatives in the middle.
    Mat3 center;
    Vec3 size(0.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0, most = 0;
            for (const double slope : slopes[axis][c]) {
                sum += slope;
                most = std::max(most, std::abs(slope));
            }
            center[static_cast<int>(axis)][static_cast<int>(c)] = sum / 48;
            size[static_cast<int>(c)] = std::max(size[static_cast<int>(c)], most);
        }
    }
    const auto scale = part_scale(center, size, error);
    if (!scale) return false;
    Vec3 sums = scale->slack * 3.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (int row = 0; row < 3; ++row) {
            const double h0 = scale->inverse[0][row], h1 = scale->inverse[1][row], h2 = scale->inverse[2][row];
            const double unit = static_cast<int>(axis) == row ? 1 : 0;
            constexpr std::size_t kLanes = 8;
            std::array<double, kLanes> most{};
            for (std::size_t k = 0; k < 48; k += kLanes) {
                for (std::size_t lane = 0; lane < kLanes; ++lane) {
                    const double away = std::abs(h0 * slopes[axis][0][k + lane] + h1 * slopes[axis][1][k + lane] +
                                                 h2 * slopes[axis][2][k + lane] - unit);
                    most[lane] = away > most[lane] ? away : most[lane];
                }
            }
            sums[row] += *std::ranges::max_element(most);
        }
    }
    return sums.x < 1 && sums.y < 1 && sums.z < 1;
}

// No rows stay none.
Eigen::MatrixXd product(const SparseRowsXd& rules, const Eigen::MatrixXd& motion) {
    return motion.rows() == 0 ? motion : Eigen::MatrixXd(rules * motion);
}

}  // namespace

const SegmentRules& segment_rules(Scheme scheme, std::size_t cells) {
    static Kept<std::pair<Scheme, std::size_t>, SegmentRules> kept;
    return kept.get({scheme, cells}, [&] {
        // Other tasks would wait for this one's lock.
        return tbb::this_task_arena::isolate([&] {
            SegmentRules rules{&edge_kind(scheme, cells), {}, {}};
            if (!rules.kind->is_bounded()) return rules;
            const EdgeRules dense = edge_rules(scheme, cells);
            rules.halves = {dense.halves[0].sparseView(), dense.halves[1].sparseView()};
            rules.ring = spline_pieces(whole_ring(dense));
            return rules;
        });
    });
}

bool proves_pieces(const SplinePieces& pieces, const Eigen::MatrixXd& window, const Eigen::MatrixXd& motion, double error) {
    constexpr int kLevels = 2;
    const Eigen::MatrixXd points = pieces.rows * window, moved = product(pieces.rows, motion);
    return std::ranges::all_of(pieces.points, [&](const std::array<Eigen::Index, 64>& piece) {
        const BezierPoints bezier = bezier_points(points, piece);
        if (moved.rows() == 0) {
            return passes_norm(bezier, error) || is_proved(PolynomialPart::tricubic(bezier, {}), error, kLevels);
        }
        return is_proved(
            MovingPart(PolynomialPart::tricubic(bezier, {}), PolynomialPart::tricubic(bezier_points(moved, piece), {})), error,
            kLevels);
    });
}

bool divide_segment(const DividedSegment& segment, int depth, std::vector<DividedSegment>& divided) {
    const auto& [rules, window, motion, error] = segment;
    if (proves_segment(*rules->kind, points_of(window), points_of(motion), error)) return true;
    if (depth == 0 || !rules->kind->is_bounded()) return false;
    // Weights of rules are positive and sum up to 1: errors do not grow, and each sum adds its rounding.
    constexpr double kOfSums = 256 * std::numeric_limits<double>::epsilon();
    const double moved = motion.rows() == 0 ? 0 : motion.cwiseAbs().maxCoeff();
    const double below = error + kOfSums * (window.cwiseAbs().maxCoeff() + moved);
    divided.push_back({rules, window, motion, below});
    for (const SparseRowsXd& half : rules->halves) {
        if (!divide_segment({rules, half * window, product(half, motion), below}, depth - 1, divided)) return false;
    }
    return true;
}

bool proves_ring(const DividedSegment& segment) {
    return proves_pieces(segment.rules->ring, segment.window, segment.motion, segment.error);
}

}  // namespace subvol::detail
