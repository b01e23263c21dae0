// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

#include "point_window.h"
#include "segment_rules.h"
#include "spline_rows.h"
#include "subvol/vec.h"

namespace subvol::detail {

// Around an irregular point all levels are powers of one matrix T, which takes the points P of the window (point_window.h) to
// those of the next window about the point. Between two windows lies the *shell*: regular small cells, and segments of
// irregular edges (edge_kind.h). With three vectors χ that T takes to nearly χ M, M = diag(λ₁, λ₂, λ₃), and vectors L,
//
//     P = 1 c + χ A + ρ,    q = ρ A⁻¹,    T P = 1 c' + χ A' + ρ',    A' = (M + C q) A,    q' = (T̄ q + R)(M + C q)⁻¹,
//
//     C = Lᵀ T Π,    T̄ = Π T Π,    R = T χ − χ M  but for constants,    Π = 1 − (1, χ) Lᵀ.
//
// C and R are roundings, as L and χ are near eigenvectors. The shell of χ + q is free of folds for all q with |q| ≤ r, where
// |q| = max |q_i| / d_i: its regular cells by Bernstein coefficients, its segments by the constants of their edges, or by those
// of their halves and the rings between. Let ν be the least λ and W = max_j |T̄ʲ| / νʲ, a maximum over finitely many j. Then
//
//     det A > 0 and W |q| < r   ⇒   det > 0 in the cells at the point but on irregular edges and at the point.
//
// Data for which |q| is not small enough are tested shell by shell until it is.

/// What is known of a kind of irregular points under a scheme: of all points whose cells meet in the same way.
struct LinkKind {
    /// A segment of an irregular edge in the shell.
    struct Segment {
        const SegmentRules* rules = nullptr;
        SparseRowsXd rows;  ///< from the point's window to that of the segment
    };
    std::vector<double> rates;             ///< the three λ
    double growth = 0;                     ///< W
    double reach = 0;                      ///< r; 0 if nothing is known of the kind
    double spread = 0;                     ///< a bound of |Π| and |Lᵀ|
    Eigen::MatrixXd characteristic, left;  ///< χ, and L of (1, χ)
    Eigen::VectorXd weights;               ///< d
    Eigen::MatrixXd rest;                  ///< T̄
    SplinePieces shell;                    ///< its regular small cells
    std::vector<Segment> segments;

    [[nodiscard]] bool is_bounded() const { return reach > 0; }
};

/// Makes a kind, with bounds of all rounding.
[[nodiscard]] LinkKind make_link_kind(Scheme scheme, const PointLink& link);

/// The kind of points with a link under a spline scheme, made when it is first asked for. Thread-safe.
[[nodiscard]] const LinkKind& link_kind(Scheme scheme, const PointLink& link);

/// Proves that no cell at a point folds, with all rounding, at all times s from −1 to 1 if its points are at x + s m. false:
/// nothing is known
///
/// points, motion: x and m of the points of the window, m of none if they do not move; error: of a coordinate
[[nodiscard]] bool proves_point(const LinkKind& kind, std::span<const Vec3> points, std::span<const Vec3> motion, double error);

}  // namespace subvol::detail
