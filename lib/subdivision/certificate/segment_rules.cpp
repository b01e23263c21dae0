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
            return passes_norm(slopes_of(bezier), error) || is_proved(PolynomialPart::tricubic(bezier, {}), error, kLevels);
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
