// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "subvol/kernel.h"

namespace subvol::detail {

/// A kernel's weight as a function of e = ρ²/R², inside e < 1, with its derivative.
struct CompactWeight {
    [[nodiscard]] double operator()(double e) const { return (1 - e) * (1 - e) * (1 - e); }
    [[nodiscard]] double derivative(double e) const { return -3 * (1 - e) * (1 - e); }
};

struct RadialWeight {
    const Kernel& kernel;
    double radius;

    [[nodiscard]] double operator()(double e) const { return radial_value(kernel, radius * std::sqrt(e)); }
    [[nodiscard]] double derivative(double e) const {
        constexpr double kStep = 1e-5;  // the cube root of a double's rounding
        const double low = std::max(e - kStep, 0.0), high = e + kStep;
        return ((*this)(high) - (*this)(low)) / (high - low);
    }
};

/// Calls use(weight) with the weight function of a radial kernel.
template <class Use>
decltype(auto) with_weight(const Kernel& kernel, const Use& use) {
    if (std::holds_alternative<CompactKernel>(kernel)) return use(CompactWeight{});
    return use(RadialWeight{kernel, support_radius(kernel)});
}

}  // namespace subvol::detail
