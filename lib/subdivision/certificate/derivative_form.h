// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "box_rules.h"

namespace subvol::detail {

// The derivative of MCQ's limit along an axis, on a cell of a grid, is linear in the differences d of neighbouring points along
// this axis:
//
//     ∂x(u) = φ(u)·d,    Σφ = 1,    and on child s with differences d' = D_s d:  φ(u) = D_sᵀ φ'(u')
//
// It is split into a polynomial of degree 2 in each parameter and a rest, e = φ − λ:
//
//     ∂x(u) = Σ_k b_k(u) (B d)_k + e(u)·d,    e(u)·v = 0 for all differences v of polynomials that the scheme reproduces.
//
// So e(u)·d = e(u)·(d − v) for any such v, and with κ ≥ sup_u Σ_i |e_i(u)|
//
//     |e(u)·d| ≤ κ max_i |d_i − v_i|.
//
// κ is proved (`proves`): with any matrix Q = I − V W, where V has a basis of these differences, eᵀ Q = eᵀ. On child s, and
// likewise on its descendants, with D the product of the matrices on the way and λ' the child's own polynomial,
//
//     e(u) = γ(u') + Dᵀ Qᵀ e'(u'),    γ = Dᵀ λ'(u') − λ(u),    so    Σ|e| ≤ max Σ|γ| + ρ κ',    ρ = max row sum of |Q D|.
//
// If Σ|γ| + ρ κ' ≤ κ on parts that cover the cell, κ' being κ or that of a type that is proved already, κ holds: for the places
// of level n by induction over n, and they are dense.

/// The derivative along the first axis, for one type of cells.
struct DerivativeForm {
    BoxType type;
    std::array<Eigen::MatrixXd, 8> steps;  ///< D_s, for the eight children
    Eigen::MatrixXd corners;    ///< φ at the corners, corner 4u + 2v + w in row; they are limits of powers, exact to rounding
    Eigen::MatrixXd bernstein;  ///< B, with a row for each of the 3×3×3 coefficients
    /// 3 B, in dyadic numbers, which takes V to 3 times the coefficients of the derivatives without an error
    Eigen::MatrixXd three_bernstein;
    Eigen::MatrixXd kept;     ///< V, in integers
    Eigen::MatrixXd weights;  ///< W: of the differences that are near d in the least squares sense, their coefficients
    Eigen::MatrixXd places;   ///< φ at the 3×3×3 corners of the children, place (9i + 3j + k) at (i, j, k) / 2

    [[nodiscard]] Eigen::Index differences() const { return corners.cols(); }
};

/// The form of a type, made when it is first asked for. The last two axes have their types in descending order. Thread-safe.
[[nodiscard]] const DerivativeForm& derivative_form(const BoxType& type);

/// The proved κ of a type; nothing if there is none. There are bounds for the 18 types of cells with two layers of others on
/// one side at least along each axis: in large boxes these are all.
[[nodiscard]] std::optional<double> derivative_bound(const BoxType& type);

/// The types with a bound, each after those of its descendants.
[[nodiscard]] std::vector<BoxType> bounded_types();

/// Whether 3 B takes V exactly to three times the derivatives.
[[nodiscard]] bool is_exact(const DerivativeForm& form);

/// Proves that κ is a bound for a type, given those of its descendants (`derivative_bound`), in interval arithmetic.
///
/// D_s, 3 B and V are dyadic and exact, which is checked, and W may be any matrix. Their products are doubles with a bound of
/// the row sums of all that was rounded, so that the sums Σ|γ| and ρ are upper bounds.
///
/// parts: how many were looked at
[[nodiscard]] bool proves(const BoxType& type, double kappa, std::size_t& parts);

}  // namespace subvol::detail
