// SPDX-License-Identifier: Apache-2.0
#include "segment_rules.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "cell_parts.h"
#include "edge_window.h"
#include "fold_test.h"
#include "kept.h"

namespace subvol::detail {

namespace {

bool is_proved(PolynomialPart part, double error, int levels) {
    const PartDecision decision = decide(part, error);
    if (decision.verdict != PartVerdict::Undecided) return decision.verdict == PartVerdict::Proved;
    if (levels == 0) return false;
    return std::ranges::all_of(part.children(),
                               [&](const PolynomialPart& child) { return is_proved(child, error, levels - 1); });
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
            rules.ring = whole_ring(dense);
            return rules;
        });
    });
}

bool proves_spline_cell(const Eigen::MatrixXd& points, double error) {
    std::array<Vec3, 64> spline{};
    for (std::size_t p = 0; p < 64; ++p) {
        const std::size_t i = p / 16, j = p / 4 % 4, k = p % 4;
        const auto row = points.row(static_cast<Eigen::Index>(p));
        spline[i + 4 * j + 16 * k] = {row(0), row(1), row(2)};
    }
    constexpr int kLevels = 2;
    return is_proved(PolynomialPart::tricubic(spline, {}), error, kLevels);
}

bool divide_segment(const DividedSegment& segment, int depth, std::vector<DividedSegment>& divided) {
    const auto& [rules, window, error] = segment;
    std::vector<Vec3> points;
    for (Eigen::Index k = 0; k < window.rows(); ++k) points.emplace_back(window(k, 0), window(k, 1), window(k, 2));
    if (proves_segment(*rules->kind, points, error)) return true;
    if (depth == 0 || !rules->kind->is_bounded()) return false;
    // Weights of rules are positive and sum up to 1: errors do not grow, and each sum adds its rounding.
    constexpr double kOfSums = 256 * std::numeric_limits<double>::epsilon();
    const double below = error + kOfSums * window.cwiseAbs().maxCoeff();
    divided.push_back({rules, window, below});
    for (const SparseRowsXd& half : rules->halves) {
        if (!divide_segment({rules, half * window, below}, depth - 1, divided)) return false;
    }
    return true;
}

bool proves_ring(const DividedSegment& segment) {
    return std::ranges::all_of(segment.rules->ring, [&](const SparseRowsXd& ring) {
        return proves_spline_cell(ring * segment.window, segment.error);
    });
}

}  // namespace subvol::detail
