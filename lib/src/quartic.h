#pragma once

#include <array>
#include <cstddef>

namespace subvol::detail {

/// The quartic Lagrange basis on the nodes 0, 1/4, 1/2, 3/4, 1: values and first and second derivatives at t. At a node the
/// values are exactly one and zeros.
struct QuarticBasis {
    static constexpr std::size_t kNodes = 5;
    std::array<double, kNodes> value{}, first{}, second{};

    explicit QuarticBasis(double t) {
        for (std::size_t i = 0; i < kNodes; ++i) {
            double p = 1, dp = 0, ddp = 0;  // the product so far and its derivatives
            for (std::size_t j = 0; j < kNodes; ++j) {
                if (j == i) continue;
                const double slope = 4.0 / (static_cast<double>(i) - static_cast<double>(j));
                const double factor = (t - static_cast<double>(j) / 4) * slope;
                ddp = ddp * factor + 2 * dp * slope;
                dp = dp * factor + p * slope;
                p *= factor;
            }
            value[i] = p;
            first[i] = dp;
            second[i] = ddp;
        }
    }
};

}  // namespace subvol::detail
