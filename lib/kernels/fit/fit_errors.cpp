// SPDX-License-Identifier: Apache-2.0
#include "fit_samples.h"

namespace subvol {

using namespace detail;

namespace {

using detail::fit_last;
using detail::fit_step;

std::size_t square(std::size_t i, std::size_t j, std::size_t k) {
    return i * i + j * j + k * k;
}

/// Count and sum of the samples at each squared distance, in squared steps; at many there is none.
struct Shells {
    std::vector<double> count, sum;
};

Shells shells_of(const BasisFunction& basis) {
    const std::size_t last = fit_last(basis), squares = square(last, last, last) + 1;
    Shells shells{std::vector<double>(squares), std::vector<double>(squares)};
    each_in_wedge(last, [&](std::size_t i, std::size_t j, std::size_t k) {
        const int times = wedge_multiplicity(i, j, k);
        shells.count[square(i, j, k)] += times;
        shells.sum[square(i, j, k)] += times * detail::basis_at(basis, i, j, k);
    });
    return shells;
}

double value_at(const Kernel& kernel, double step, std::size_t i, std::size_t j, std::size_t k) {
    return kernel_value(kernel, step * Vec3(i, j, k));
}

}  // namespace

detail::RadialSamples detail::radial_samples(const BasisFunction& basis) {
    const Shells shells = shells_of(basis);
    const double samples = std::pow(2.0 * static_cast<double>(fit_last(basis)) + 1, 3);
    RadialSamples radial;
    for (std::size_t s = 0; s < shells.count.size(); ++s) {
        if (shells.count[s] == 0) continue;
        radial.rho.push_back(fit_step(basis) * std::sqrt(static_cast<double>(s)));
        radial.mean.push_back(shells.sum[s] / shells.count[s]);
        radial.count.push_back(shells.count[s] / samples);
    }
    return radial;
}

FitErrors kernel_errors(const BasisFunction& basis, const Kernel& kernel) {
    return detail::wedge_errors(
        basis, [&](std::size_t i, std::size_t j, std::size_t k) { return value_at(kernel, fit_step(basis), i, j, k); });
}

FitErrors radial_bound(const BasisFunction& basis) {
    const Shells shells = shells_of(basis);
    return detail::wedge_errors(basis, [&](std::size_t i, std::size_t j, std::size_t k) {
        return shells.sum[square(i, j, k)] / shells.count[square(i, j, k)];
    });
}

FitErrors kernel_errors_float32(const BasisFunction& basis, const Kernel& kernel) {
    std::vector<float> errors;  // of the wedge
    each_in_wedge(fit_last(basis), [&](std::size_t i, std::size_t j, std::size_t k) {
        const auto value = static_cast<float>(value_at(kernel, fit_step(basis), i, j, k));
        errors.push_back(value - static_cast<float>(detail::basis_at(basis, i, j, k)));
    });
    float squares = 0, sum = 0, max = 0;
    const int last = static_cast<int>(fit_last(basis));
    for (int k = -last; k <= last; ++k) {
        for (int j = -last; j <= last; ++j) {
            for (int i = -last; i <= last; ++i) {
                const float error = std::abs(errors[wedge_index_of(i, j, k)]);
                squares += error * error;
                sum += error;
                max = std::max(max, error);
            }
        }
    }
    const auto samples = static_cast<float>(std::pow(2.0 * last + 1, 3));
    const float mse = squares / samples;
    return {.mse = mse, .rmse = std::sqrt(mse), .mae = sum / samples, .max = max};
}

}  // namespace subvol
