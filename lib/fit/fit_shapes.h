// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "least_squares.h"
#include "subvol/fit_kernel.h"

namespace subvol::detail {

// The fits of each shape. `fit_kernel` checks the options and fills in the errors.

[[nodiscard]] KernelFit fit_cubic(const BasisFunction& basis, KernelShape shape, const FitOptions& options);
[[nodiscard]] KernelFit fit_gaussian(const BasisFunction& basis);
[[nodiscard]] KernelFit fit_gaussian_sum(const BasisFunction& basis, int terms);
[[nodiscard]] KernelFit fit_scaled_gaussian(const BasisFunction& basis);
[[nodiscard]] KernelFit fit_wendland_c2(const BasisFunction& basis);
[[nodiscard]] KernelFit fit_wendland_c4(const BasisFunction& basis);
[[nodiscard]] KernelFit fit_separable_gaussian(const BasisFunction& basis);
[[nodiscard]] KernelFit fit_separable_table(const BasisFunction& basis);

/// The search for a width or radius.
[[nodiscard]] inline Unknown length_from(double start) {
    return {.start = start, .lower = 0.05, .upper = 6};
}

[[nodiscard]] inline FitReport report_of(const Minimum& minimum, int parameters) {
    return {.errors = {}, .parameters = parameters, .iterations = minimum.iterations, .converged = minimum.converged};
}

}  // namespace subvol::detail
