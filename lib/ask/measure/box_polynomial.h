// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "subvol/vec.h"

namespace subvol::detail {

/// The Bézier coefficients of a triquadratic polynomial over a box, u fastest, then v, then w. The polynomial lies between the
/// least and the largest of them, and those at the corners are its values there.
using BoxPolynomial = std::array<double, 27>;

/// From a coefficient to the next one along each axis.
inline constexpr std::array<std::size_t, 3> kCoefficientSteps{1, 3, 9};

/// values: at 0, ½ and 1 along each axis
[[nodiscard]] BoxPolynomial polynomial_through(const BoxPolynomial& values);
/// The same polynomial over a part of the box, whose corners are given in [0,1]³.
[[nodiscard]] BoxPolynomial restricted(const BoxPolynomial& polynomial, const Vec3& lower, const Vec3& upper);
/// The three coefficients along a line of the box. at: along the other two axes
[[nodiscard]] std::array<double, 3> on_line(const BoxPolynomial& polynomial, int axis, const Vec3& at);
[[nodiscard]] double value_at(const BoxPolynomial& polynomial, const Vec3& at);
[[nodiscard]] Vec3 slope_at(const BoxPolynomial& polynomial, const Vec3& at);

/// The coefficients of the product of two quadratics.
[[nodiscard]] std::array<double, 5> product(const std::array<double, 3>& a, const std::array<double, 3>& b);

/// Appends the places in (0,1) at which a polynomial with these Bézier coefficients changes its sign, in order.
void add_roots(std::span<const double> coefficients, std::vector<double>& roots);

}  // namespace subvol::detail
