// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "edge_window.h"
#include "subvol/vec.h"

namespace subvol::detail {

// Around a segment of an irregular edge with m cells the limit of a spline scheme is decided at all levels at once. Let P be
// the N points of the window of the segment (edge_window.h), T_h the rules that lead to the windows of its two halves, T_σ
// their product along a word σ of halves. What becomes regular in one level, the *ring*, has six small cells in each sector:
//
//        ┌───┬───┐
//        │ × │ × │      sector: the cells × of both halves are the ring; the cell at the edge is left for the next level.
//        ├───┼───┤      So the m cells are the rings of T_σ P for all words σ, and the edge.
//        ┃ e │ × │
//        ┗━━━┷━━━┛
//
// The characteristic map χ = (χ₁, χ₂, w) satisfies T_h (χ₁, χ₂) = λ (χ₁, χ₂) and T_h w = w/2 ± 1/4 (from the middle of the
// segment). Left vectors L with Lᵀ(1, χ) = 1 split P = 1 c + χ A + ρ; Π takes P to ρ, and T̄ = Π T Π. With q = ρ A⁻¹ and
// Λ = diag(λ, λ, ½), level j has
//
//     T_σ P = 1 c' + (χ Λʲ (1 + E) + T̄_σ q) A,     E = Σ_{i<j} Λ^−(i+1) (Lᵀ T_h T̄_σᵢ) q,     σᵢ: the first i letters of σ
//
// and at a place of the ring with ∂ its derivatives, and H near (∂χ)⁻¹ there,
//
//     Λ^−j H ∂(T_σ P) A⁻¹ = (1 + Δ) (1 + E) + Λ^−j H ∂ T̄_σ q,      Δ = H ∂χ − 1, |Δ| ≤ κ < 1.
//
// If x is in the kernel of this matrix and y = q₁₂ |x₁₂| + q₃ |x₃|, where q₁₂ = max |(q_i1, q_i2)| / d_i and q₃ = max |q_i3| /
// d_i with weights d of the points, then |x₁₂| ≤ K₁₂ y and |x₃| ≤ K₃ y with
//
//     K₁₂ ≥ ( Σ_k |(H ∂ T̄_σ)_k| d_k / (1 − κ) ) / λʲ + Σ_{i<j} Σ_k |(Lᵀ T T̄_σᵢ)_k| d_k / λ^(i+1)       rows 1 and 2, at all
//     levels
//
// and likewise K₃ of row 3, with ½ for λ. So y ≤ (K₁₂ q₁₂ + K₃ q₃) y, and
//
//     det A > 0 and K₁₂ q₁₂ + K₃ q₃ < 1   ⇒   det > 0 in the m cells but on the edge. (*)
//
// K₁₂ and K₃ are maxima over finitely many words because products of T̄ fall: a product over `words` levels is at most ω < 1.
//
// With five cells or more there are two vectors ψ, constant along the edge, with T_h ψ = μ ψ in both halves, of which the rest
// falls slowly. They are taken apart as χ is, with Lᵀ(1, χ, ψ) = 1 and Π = 1 − (1, χ, ψ) Lᵀ: q = ψ C + q'. The 2×3 matrix
// C = (C₁₂ C₃) becomes μ C + Lᵀ T_h q', and ψ adds nothing to E or row 3. So with S ≥ |H ∂ψ| / (1 − κ) on the ring, F_i as the
// sums of E for the rows of L that belong to ψ, s₁₂ = S |C₁₂|, s₃ = S |C₃|, and K and y of q'
//
//     K₁₂ ≥ … + S Σ_{i<j} F_i (μ/λ)^(j − 1 − i),    |x₃| ≤ K₃ y,    |x₁₂| ≤ K₁₂ y + s₁₂ |x₁₂| + s₃ |x₃|,    and for s₁₂ < 1
//
//     det A > 0 and q'₁₂ (K₁₂ + s₃ K₃) / (1 − s₁₂) + K₃ q'₃ < 1   ⇒   det > 0 in the m cells but on the edge. (**)

/// The constants of (*) and (**) for one scheme and number of cells. They are upper bounds, with all rounding.
struct EdgeKind {
    /// What was found for words of a length, at most; `across` of rows 1 and 2, `along` of row 3.
    struct Level {
        double ring_across = 0, ring_along = 0;    ///< of the ring, that many levels below
        double drift_across = 0, drift_along = 0;  ///< of what the rest adds to A
        double drift_slow = 0;                     ///< of what it adds to C
    };
    std::size_t cells = 0;
    double rate = 0;                                                                                           ///< λ
    double across = std::numeric_limits<double>::infinity(), along = std::numeric_limits<double>::infinity();  ///< K₁₂, K₃
    double spread = 0;                                   ///< a bound of |Π|, as it takes errors of points to those of ρ
    std::size_t words = 0;                               ///< the length of words whose products fall
    double falls_across = 0, falls_along = 0;            ///< ω, for rows 1 and 2, and for row 3
    double kappa = 0;                                    ///< κ, the largest of all parts of the ring
    std::vector<Level> levels;                           ///< up to that length
    std::vector<std::array<double, 3>> characteristic;   ///< χ of the points of the window
    std::vector<std::array<double, 4>> left;             ///< L, of (1, χ₁, χ₂, w)
    std::vector<double> weights;                         ///< d
    double slow_rate = 0, slow_size = 0;                 ///< μ and S; ψ = 0 with three cells
    std::vector<std::array<double, 2>> slow, slow_left;  ///< ψ, and L of ψ

    /// Whether the kind has constants.
    [[nodiscard]] bool is_bounded() const { return across < std::numeric_limits<double>::infinity(); }
};

/// Makes the constants from the rules, in interval arithmetic. Without bounds if the rules are not as symmetric as those of a
/// scheme, or their products do not fall.
[[nodiscard]] EdgeKind make_edge_kind(const EdgeRules& rules);

/// The kind of the edges with so many cells under a spline scheme, made when it is first asked for. Thread-safe.
[[nodiscard]] const EdgeKind& edge_kind(Scheme scheme, std::size_t cells);

/// The largest factor by which a 2×2 matrix changes lengths, rounded up.
[[nodiscard]] double spectral_norm(const Eigen::Matrix2d& matrix);

/// Proves (**) for a window, with all rounding, at all times s from −1 to 1 if its points are at x + s m. With A and A_M of
/// both and N = A_M A⁻¹, |N| < 1, q(s) = (q + s q_M) (1 + s N)⁻¹ = q + s (q_M − q N) (1 + s N)⁻¹. false: nothing is known
///
/// points, motion: x and m of the points of the window, m of none if they do not move; error: of a coordinate
[[nodiscard]] bool proves_segment(const EdgeKind& kind, std::span<const Vec3> points, std::span<const Vec3> motion,
                                  double error);

}  // namespace subvol::detail
