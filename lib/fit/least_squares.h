// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

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

}  // namespace subvol::detail
