// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "subvol/basis_function.h"
#include "subvol/fit_kernel.h"

namespace subvol::detail {

inline constexpr int kFitReach = 3;  // fits use [−3,3]³

/// The last index along an axis, and the distance between samples.
[[nodiscard]] inline std::size_t fit_last(const BasisFunction& basis) {
    return static_cast<std::size_t>(kFitReach) << basis.level;
}
[[nodiscard]] inline double fit_step(const BasisFunction& basis) {
    return std::ldexp(1.0, -basis.level);
}
[[nodiscard]] inline double basis_at(const BasisFunction& basis, std::size_t i, std::size_t j, std::size_t k) {
    return basis.at(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k));
}

/// The means of the samples at each distance. For a radial kernel, least squares over these means, weighted by `count`, are
/// equivalent to those over all samples.
struct RadialSamples {
    std::vector<double> rho, mean;
    std::vector<double> count;  ///< as a part of the number of all samples

    [[nodiscard]] std::size_t size() const { return rho.size(); }
};

[[nodiscard]] RadialSamples radial_samples(const BasisFunction& basis);

/// Errors of model(i, j, k) over all samples, by way of the wedge.
template <class Model>
[[nodiscard]] FitErrors wedge_errors(const BasisFunction& basis, const Model& model) {
    FitErrors errors;
    each_in_wedge(fit_last(basis), [&](std::size_t i, std::size_t j, std::size_t k) {
        const double error = std::abs(model(i, j, k) - basis_at(basis, i, j, k));
        const int times = wedge_multiplicity(i, j, k);
        errors.mse += times * error * error;
        errors.mae += times * error;
        errors.max = std::max(errors.max, error);
    });
    const double samples = std::pow(2.0 * static_cast<double>(fit_last(basis)) + 1, 3);
    errors.mse /= samples;
    errors.mae /= samples;
    errors.rmse = std::sqrt(errors.mse);
    return errors;
}

}  // namespace subvol::detail
