// SPDX-License-Identifier: Apache-2.0
#include "fit_samples.h"
#include "fit_shapes.h"
#include "least_squares.h"

namespace subvol::detail {

namespace {

std::vector<double> profile(const RadialSamples& samples, const Kernel& kernel) {
    std::vector<double> values;
    for (const double rho : samples.rho) values.push_back(radial_value(kernel, rho));
    return values;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
    return result;
}

/// Turns the column of B into that of a kernel with +3/2·B in the inner cubic coefficient.
void slip(const RadialSamples& samples, double extent, std::vector<double>& column) {
    for (std::size_t i = 0; i < samples.size() && samples.rho[i] < extent / 2; ++i) {
        column[i] += 3 * samples.rho[i] * samples.rho[i] * samples.rho[i];
    }
}

}  // namespace

// Both families are linear in their parameters: a constant function and one column a parameter.
KernelFit fit_cubic(const BasisFunction& basis, KernelShape shape, const FitOptions& options) {
    const double extent = options.extent;
    const RadialSamples samples = radial_samples(basis);
    const auto of = [&](double b, double c) { return profile(samples, BcSplineKernel{.b = b, .c = c, .extent = extent}); };
    const std::vector<double> constant = of(0, 0), target = difference(samples.mean, constant);
    if (shape == KernelShape::CardinalSpline) {
        const std::vector<std::vector<double>> columns{difference(constant, of(0, 1))};  // a = −C
        const double a = linear_fit(samples.count, target, columns)[0];
        return {CardinalSplineKernel{.a = a, .extent = extent}, {.errors = {}, .parameters = 1}};
    }
    std::vector<std::vector<double>> columns{difference(of(1, 0), constant), difference(of(0, 1), constant)};
    if (options.sign_slip) slip(samples, extent, columns[0]);
    const auto bc = linear_fit(samples.count, target, columns);
    return {BcSplineKernel{.b = bc[0], .c = bc[1], .extent = extent}, {.errors = {}, .parameters = 2}};
}

}  // namespace subvol::detail
