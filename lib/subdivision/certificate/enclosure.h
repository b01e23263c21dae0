// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

namespace subvol::detail {

// Interval arithmetic in the norm that the proofs need, the largest sum of magnitudes in a row: a matrix of doubles, and by how
// much the row sums of its difference from the true matrix may be off.

inline constexpr double kUnitRoundoff = 0x1p-53;

/// A little more than a bound: more than what rounding takes from any sum of bounds in a proof.
inline double up(double x) {
    return x * (1 + 0x1p-40);
}

/// The largest row sum of magnitudes.
template <class Derived>
[[nodiscard]] double norm(const Eigen::MatrixBase<Derived>& matrix) {
    return up(matrix.cwiseAbs().rowwise().sum().maxCoeff());
}

/// The rounding error of a sum of `terms` products, as a part of the sum of their magnitudes, for any order of the terms.
/// Underflow is far below.
inline double rounding(Eigen::Index terms) {
    return 1.01 * static_cast<double>(terms + 1) * kUnitRoundoff;
}

/// A matrix that is known up to an error: the row sums of |true − near| are at most `off`.
struct Enclosure {
    Eigen::MatrixXd near;
    double off = 0;

    /// An upper bound of the norm of the true matrix.
    [[nodiscard]] double most() const { return up(norm(near) + off); }
};

/// The product of a matrix without an error and an enclosure.
///
/// by_norm: the norm of `by`; terms: the most entries in a row of `by` that are not 0
template <class Matrix>
[[nodiscard]] Enclosure times(const Matrix& by, double by_norm, Eigen::Index terms, const Enclosure& with) {
    return {by * with.near, up(by_norm * (with.off + rounding(terms) * norm(with.near)))};
}

[[nodiscard]] inline Enclosure times(const Enclosure& a, const Enclosure& b) {
    const double a_norm = norm(a.near), b_norm = norm(b.near);
    return {a.near * b.near, up(a_norm * (b.off + rounding(a.near.cols()) * b_norm) + a.off * (b_norm + b.off))};
}

[[nodiscard]] inline Enclosure minus(const Enclosure& a, const Enclosure& b) {
    Eigen::MatrixXd near = a.near - b.near;
    const double rounded = 2 * kUnitRoundoff * norm(near);
    return {std::move(near), up(a.off + b.off + rounded)};
}

}  // namespace subvol::detail
