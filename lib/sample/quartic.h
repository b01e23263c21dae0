// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace subvol::detail {

/// The quartic Lagrange basis on the nodes 0, 1/4, 1/2, 3/4, 1. At a node the values are exactly one and zeros.
struct QuarticBasis {
    static constexpr std::size_t kNodes = 5;
    using Weights = std::array<double, kNodes>;
    Weights value{}, first{};

    explicit QuarticBasis(double t) {
        for (std::size_t i = 0; i < kNodes; ++i) {
            double p = 1, dp = 0;  // the product so far and its derivative
            for (std::size_t j = 0; j < kNodes; ++j) {
                if (j == i) continue;
                const double slope = 4.0 / (static_cast<double>(i) - static_cast<double>(j));
                const double factor = (t - static_cast<double>(j) / 4) * slope;
                dp = dp * factor + p * slope;
                p *= factor;
            }
            value[i] = p;
            first[i] = dp;
        }
    }
};

/// What a kernel needs to know along one axis of a cell, per sample interval: weights of the value, of the derivative, and of
/// the second difference between samples.
///
/// The second difference is that of the neighbouring samples, not the second derivative: a kernel reaches over them, and limit
/// curves need not have a second derivative. At a side of the cell, where one neighbour is missing, the derivative stands in:
/// 2 (f(t+s) − f(t) − s f′(t)); the cell on the other side supplies the other half.
struct SampleStencil {
    QuarticBasis::Weights value{}, first{}, second{};

    SampleStencil(double t, double step) {
        const QuarticBasis here(t);
        value = here.value;
        for (std::size_t i = 0; i < value.size(); ++i) first[i] = step * here.first[i];
        constexpr double kSlack = 1e-9;  // t ± step of the outermost samples is rounded
        const bool below = t - step > -kSlack, above = t + step < 1 + kSlack;
        const QuarticBasis low(t - step), high(t + step);
        for (std::size_t i = 0; i < value.size(); ++i) {
            const double down = below ? low.value[i] - value[i] : high.value[i] - value[i] - 2 * first[i];
            const double up = above ? high.value[i] - value[i] : low.value[i] - value[i] + 2 * first[i];
            second[i] = down + up;
        }
    }
};

}  // namespace subvol::detail
