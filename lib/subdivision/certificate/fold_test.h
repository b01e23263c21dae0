// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "bernstein.h"

namespace subvol::detail {

/// J at places of a part.
struct PartJacobians {
    std::vector<Mat3> at;
    Vec3 size{0.0};  ///< no differences of neighbouring points, of which the columns are sums, are larger in a component
};

/// What is known of the Jacobian of a part in some coordinates.
struct PartDerivatives {
    BernsteinColumns columns;  ///< polynomials near its columns
    Mat3 rest{0.0};            ///< how far these may be off, component by component
};

enum class PartVerdict { Proved, Folded, Undecided };

struct PartDecision {
    PartVerdict verdict = PartVerdict::Undecided;
    std::size_t place = 0;   ///< the place where the part folds
    double determinant = 0;  ///< the determinant there
};

/// Decides whether det J > 0 on a part. With G the polynomial at its centre, H an inverse of G, Y = H J and the rest R ≥ |H E|:
///
///     norm         max over coefficients and rows of Σ_c |Y − 1| + R < 1: all matrices between G and J are regular
///     determinant  the least Bernstein coefficient of det Y exceeds per(|Y| + R) − per(|Y|), the permanents of what is largest
///     witness      det J at a corner is below zero by more than its rounding
///
/// Part: has its Jacobians at the corners (4u + 2v + w), G, the size of its differences, and its derivatives in the coordinates
///       that a matrix leads to
/// error: of a point's coordinates
template <class Part>
[[nodiscard]] PartDecision decide(const Part& part, double error);

/// Looks for the worst fold at places alone: never `Proved`. error: as for `decide`
[[nodiscard]] PartDecision witness(const PartJacobians& part, double error);

/// H for a part, and what is added to the rest in its coordinates because of rounding; nothing if G has no certain inverse.
struct PartScale {
    Mat3 inverse;
    Vec3 slack;
};
[[nodiscard]] std::optional<PartScale> part_scale(const Mat3& center, const Vec3& size, double error);

/// Whether one of the first two tests is passed. scaled: in the coordinates of H, without the slack
[[nodiscard]] bool is_positive(PartDerivatives scaled, const Vec3& slack);

/// Coefficients of derivatives that are polynomials: for each axis and coordinate.
template <std::size_t kCoefficients>
using PartSlopes = std::array<std::array<std::array<double, kCoefficients>, 3>, 3>;

/// The first test of `decide` alone, which most parts pass, without a part being made. Made for 4 and 48 coefficients.
template <std::size_t kCoefficients>
[[nodiscard]] bool passes_norm(const PartSlopes<kCoefficients>& slopes, double error);

template <class Part>
PartDecision decide(const Part& part, double error) {
    const auto scale = part_scale(part.center(), part.size(), error);
    if (scale && is_positive(part.derivatives(scale->inverse), scale->slack)) return {PartVerdict::Proved};
    return witness(part.corners(), error);  // most parts are proved, so a fold is looked for afterwards
}

}  // namespace subvol::detail
