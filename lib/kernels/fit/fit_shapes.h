// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "subvol/fit_kernel.h"

namespace subvol::detail {

/// Writes the residuals for some parameters.
using Residuals = std::function<void(std::span<const double> parameters, std::span<double> residuals)>;

struct Minimum {
    std::vector<double> parameters;
    int iterations = 0;
    bool converged = false;
};

/// The start of the search for one parameter, and its bounds.
struct Unknown {
    double start, lower, upper;
};

/// The parameters with the least sum of squared residuals near the start: Levenberg-Marquardt with central differences.
[[nodiscard]] Minimum minimize_squares(std::span<const Unknown> unknowns, std::size_t residuals, const Residuals& function);

/// The factors with the least Σ weights·(target − Σ factor·column)².
[[nodiscard]] std::vector<double> linear_fit(std::span<const double> weights, std::span<const double> target,
                                             std::span<const std::vector<double>> columns);

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
