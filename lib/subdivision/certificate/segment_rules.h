// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <vector>

#include "edge_kind.h"
#include "spline_rows.h"
#include "subvol/scheme.h"

namespace subvol::detail {

/// The rules of a segment of an irregular edge (edge_window.h).
struct SegmentRules {
    const EdgeKind* kind = nullptr;
    std::array<SparseRowsXd, 2> halves;  ///< from the window of the segment to those of its halves
    SplinePieces ring;                   ///< the small cells between the segment and its halves
};

/// Those of edges with so many cells under a spline scheme, made when first asked for. Thread-safe.
[[nodiscard]] const SegmentRules& segment_rules(Scheme scheme, std::size_t cells);

/// A segment whose ring has to be proved cell by cell. window, motion: x, y, z of each point, and how far it moves on both
/// sides of there (no rows: it does not); error: of a coordinate
struct DividedSegment {
    const SegmentRules* rules;
    Eigen::MatrixXd window, motion;
    double error;
};

/// Of a segment: more take twice the time each, and hardly decide more.
constexpr int kMostHalvings = 6;

/// Halves a segment until the constants of its kind prove all parts. What is left to prove are the rings of those that were
/// halved, which are added to `divided`. false: the parts are not proved
///
/// depth: how often the segment may be halved
[[nodiscard]] bool divide_segment(const DividedSegment& segment, int depth, std::vector<DividedSegment>& divided);

/// Proves that no cell of the ring of a segment folds. false: nothing is known
[[nodiscard]] bool proves_ring(const DividedSegment& segment);

/// Proves that none of the pieces of a window folds. window, motion, error: as in DividedSegment
[[nodiscard]] bool proves_pieces(const SplinePieces& pieces, const Eigen::MatrixXd& window, const Eigen::MatrixXd& motion,
                                 double error);

}  // namespace subvol::detail
