// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "bernstein.h"
#include "derivative_form.h"

namespace subvol::detail {

/// J at the corners of a part.
struct PartCorners {
    std::array<Mat3, 8> corners;  ///< 4u + 2v + w
    Vec3 size{0.0};  ///< the largest differences of neighbouring points, component by component, of which the columns are sums
};

/// What is known of the Jacobian J of a part.
struct PartDerivatives {
    struct Rest {
        double kappa = 0;
        std::vector<Vec3> differences;
    };
    BernsteinColumns columns;  ///< polynomials near the columns of J
    /// For each axis the bound and the vectors that it bounds: J's column is within kappa × (the differences) of the
    /// polynomial, component by component in any coordinates; empty if it is the polynomial
    std::array<Rest, 3> rest;
    PartCorners at;
};

enum class PartVerdict { Proved, Folded, Undecided };

struct PartDecision {
    PartVerdict verdict = PartVerdict::Undecided;
    std::size_t corner = 0;  ///< corner of a folded part
    double determinant = 0;  ///< determinant of a folded part
};

/// Decides whether det J > 0 on a part. With G the polynomial at its centre, H an inverse of G, Y = H J and the rest R ≥ |H E|:
///
///     norm         max over coefficients and rows of Σ_c |Y − 1| + R < 1: all matrices between G and J are regular
///     determinant  the least Bernstein coefficient of det Y exceeds per(|Y| + R) − per(|Y|), the permanents of what is largest
///     witness      det J at a corner is below zero by more than its rounding
///
/// error: of a point's coordinates
[[nodiscard]] PartDecision decide(const PartDerivatives& part, double error);

/// Looks for a fold at the corners alone: never `Proved`. error: as for `decide`
[[nodiscard]] PartDecision witness(const PartCorners& part, double error);

}  // namespace subvol::detail
