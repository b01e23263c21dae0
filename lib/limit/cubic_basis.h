// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace subvol::detail {

/// Weights of four grid points at −1, 0, 1, 2 for a place t in [0,1], and their derivatives.
struct CubicBasis {
    std::array<double, 4> value{}, first{};

    /// The uniform cubic B-spline.
    static CubicBasis spline(double t) {
        const double s = 1 - t;
        return {{s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6},
                {-s * s / 2, (3 * t * t - 4 * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2}};
    }

    /// The polynomial through the four points; exactly one of them where t is 0 or 1.
    static CubicBasis lagrange(double t) {
        const double a = t + 1, b = t, c = t - 1, d = t - 2;
        return {{-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6},
                {-(c * d + b * d + b * c) / 6, (c * d + a * d + a * c) / 2, -(b * d + a * d + a * b) / 2,
                 (b * c + a * c + a * b) / 6}};
    }

    /// The line between the two inner points.
    static CubicBasis linear(double t) { return {{0, 1 - t, t, 0}, {0, -1, 1, 0}}; }
};

}  // namespace subvol::detail
