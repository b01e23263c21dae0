// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "subvol/detail/add_times.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

/// The length of a step, or how much of the last direction is kept: 0 where there is nothing left to divide by.
inline double step_ratio(double a, double b) {
    return b > 0 ? a / b : 0;
}
template <std::size_t N>
std::array<double, N> step_ratio(const std::array<double, N>& a, const std::array<double, N>& b) {
    std::array<double, N> ratios;
    for (std::size_t i = 0; i < N; ++i) ratios[i] = step_ratio(a[i], b[i]);
    return ratios;
}

inline double opposite(double length) {
    return -length;
}
template <std::size_t N>
std::array<double, N> opposite(std::array<double, N> lengths) {
    for (double& length : lengths) length = -length;
    return lengths;
}

inline bool is_step(double length) {
    return length > 0;
}
template <std::size_t N>
bool is_step(const std::array<double, N>& lengths) {
    return std::any_of(lengths.begin(), lengths.end(), [](double length) { return length > 0; });
}

/// Conjugate gradients: of a symmetric system A x = b with rest = b − A x, or of least squares |A x − b|² with the same rest
/// (CGLS), which works with the rest itself and not with that of the normal equations. Several systems with one matrix are
/// solved side by side if the items of x are arrays, one number for each system; products are arrays then, too.
///
/// x, rest:   changed in each step by the direction and its image, times a length
/// gradient:  gradient(scaled) sets scaled = M g, g being the rest, of least squares Aᵀ rest, and M ≈ A⁻¹ or (AᵀA)⁻¹; returns
///            g · M g
/// apply:     apply(direction, image) sets image = A direction
/// curvature: curvature(direction, image) returns direction · image, of least squares image · image; where it is not above 0
///            the search ends
/// goes_on:   goes_on(step, product) with what gradient returned last, before each step
/// returns:   the number of steps
///
/// Bitwise the same for any number of threads if the four are.
template <class Vector, class Rest, class Gradient, class Apply, class Curvature, class GoesOn>
int conjugate_gradients(Vector& x, Rest& rest, const Gradient& gradient, const Apply& apply, const Curvature& curvature,
                        const GoesOn& goes_on) {
    Vector scaled(x.size());
    Rest image(rest.size());
    auto product = gradient(scaled);
    Vector direction = scaled;
    int step = 0;
    for (; goes_on(step, product); ++step) {
        apply(direction, image);
        const auto length = step_ratio(product, curvature(direction, image));
        if (!is_step(length)) break;
        const auto back = opposite(length);
        parallel_each(x.size(), [&](std::size_t i) { add_times(x[i], length, direction[i]); });
        parallel_each(rest.size(), [&](std::size_t i) { add_times(rest[i], back, image[i]); });
        const auto next = gradient(scaled);
        const auto kept = step_ratio(next, product);
        parallel_each(x.size(), [&](std::size_t i) { add_times(scaled[i], kept, direction[i]); });
        std::swap(direction, scaled);
        product = next;
    }
    return step;
}

}  // namespace subvol::detail
