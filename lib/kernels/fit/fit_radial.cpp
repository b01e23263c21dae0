// SPDX-License-Identifier: Apache-2.0
#include "fit_samples.h"
#include "fit_shapes.h"

namespace subvol::detail {

namespace {

constexpr double kLeastRatio = 1.25;  // of the widths of two Gaussians: closer ones cancel, with unbounded amplitudes

/// Makes a kernel of amplitude 1 from its only length.
using ByLength = Kernel (*)(double);

Kernel gaussian(double sigma) {
    return GaussianKernel{.sigma = sigma};
}

/// A sum of amplitude·kernel(length): lengths are searched for, amplitudes follow by linear least squares.
struct ScaledSum {
    RadialSamples samples;
    ByLength kernel;

    [[nodiscard]] std::vector<std::vector<double>> columns(std::span<const double> lengths) const {
        std::vector<std::vector<double>> all;
        for (const double length : lengths) {
            const Kernel term = kernel(length);
            auto& column = all.emplace_back();
            for (const double rho : samples.rho) column.push_back(radial_value(term, rho));
        }
        return all;
    }
    [[nodiscard]] std::vector<double> amplitudes(std::span<const double> lengths) const {
        return linear_fit(samples.count, samples.mean, columns(lengths));
    }
    void residuals(std::span<const double> lengths, std::span<double> to) const {
        const auto all = columns(lengths);
        const auto factors = linear_fit(samples.count, samples.mean, all);
        for (std::size_t i = 0; i < to.size(); ++i) {
            double error = -samples.mean[i];
            for (std::size_t n = 0; n < all.size(); ++n) error += factors[n] * all[n][i];
            to[i] = std::sqrt(samples.count[i]) * error;
        }
    }
};

/// Length and amplitude of one term.
struct OneTerm {
    double length, amplitude;
    FitReport report;
};

OneTerm fit_one_term(const BasisFunction& basis, ByLength kernel, double start) {
    const ScaledSum sum{radial_samples(basis), kernel};
    const Minimum minimum =
        minimize_squares(std::vector{length_from(start)}, sum.samples.size(),
                         [&](std::span<const double> length, std::span<double> to) { sum.residuals(length, to); });
    return {minimum.parameters[0], sum.amplitudes(minimum.parameters)[0], report_of(minimum, 2)};
}

/// Widths from the first one and the ratio of each to the one before.
std::vector<double> widths_of(std::span<const double> ratios) {
    std::vector<double> widths(ratios.begin(), ratios.end());
    for (std::size_t i = 1; i < widths.size(); ++i) widths[i] *= widths[i - 1];
    return widths;
}

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

/// Changes the column of B to that of a kernel with +3/2·B in the inner cubic coefficient.
void slip(const RadialSamples& samples, double extent, std::vector<double>& column) {
    for (std::size_t i = 0; i < samples.size() && samples.rho[i] < extent / 2; ++i) {
        column[i] += 3 * samples.rho[i] * samples.rho[i] * samples.rho[i];
    }
}

}  // namespace

KernelFit fit_gaussian(const BasisFunction& basis) {
    const RadialSamples samples = radial_samples(basis);
    const auto residuals = [&](std::span<const double> sigma, std::span<double> to) {
        const Kernel kernel = gaussian(sigma[0]);
        for (std::size_t i = 0; i < to.size(); ++i) {
            to[i] = std::sqrt(samples.count[i]) * (radial_value(kernel, samples.rho[i]) - samples.mean[i]);
        }
    };
    const Minimum minimum = minimize_squares(std::vector{length_from(0.5)}, samples.size(), residuals);
    return {gaussian(minimum.parameters[0]), report_of(minimum, 1)};
}

KernelFit fit_scaled_gaussian(const BasisFunction& basis) {
    const OneTerm term = fit_one_term(basis, gaussian, 0.5);
    return {GaussianKernel{.sigma = term.length, .amplitude = term.amplitude}, term.report};
}

KernelFit fit_wendland_c2(const BasisFunction& basis) {
    const OneTerm term = fit_one_term(
        basis,
        [](double r) {
            return Kernel(WendlandC2Kernel{r, 1});
        },
        2);
    return {WendlandC2Kernel{term.length, term.amplitude}, term.report};
}

KernelFit fit_wendland_c4(const BasisFunction& basis) {
    const OneTerm term = fit_one_term(
        basis,
        [](double r) {
            return Kernel(WendlandC4Kernel{r, 1});
        },
        2);
    return {WendlandC4Kernel{term.length, term.amplitude}, term.report};
}

KernelFit fit_gaussian_sum(const BasisFunction& basis, int terms) {
    const ScaledSum sum{radial_samples(basis), gaussian};
    std::vector<Unknown> unknowns{length_from(0.45)};
    while (unknowns.size() < static_cast<std::size_t>(terms)) unknowns.push_back({1.6, kLeastRatio, 4});
    const Minimum minimum =
        minimize_squares(unknowns, sum.samples.size(),
                         [&](std::span<const double> ratios, std::span<double> to) { sum.residuals(widths_of(ratios), to); });
    const std::vector<double> widths = widths_of(minimum.parameters);
    return {GaussianSumKernel{.amplitudes = sum.amplitudes(widths), .sigmas = widths}, report_of(minimum, 2 * terms)};
}

// Both families are linear in their parameters: a constant function and one column per parameter.
KernelFit fit_cubic(const BasisFunction& basis, KernelShape shape, const FitOptions& options) {
    const double extent = options.extent;
    const RadialSamples samples = radial_samples(basis);
    const auto profile_of = [&](double b, double c) {
        return profile(samples, BcSplineKernel{.b = b, .c = c, .extent = extent});
    };
    const std::vector<double> constant = profile_of(0, 0), target = difference(samples.mean, constant);
    if (shape == KernelShape::CardinalSpline) {
        const std::vector<std::vector<double>> columns{difference(constant, profile_of(0, 1))};  // a = −C
        const double a = linear_fit(samples.count, target, columns)[0];
        return {CardinalSplineKernel{.a = a, .extent = extent}, {.errors = {}, .parameters = 1}};
    }
    std::vector<std::vector<double>> columns{difference(profile_of(1, 0), constant), difference(profile_of(0, 1), constant)};
    if (options.sign_slip) slip(samples, extent, columns[0]);
    const auto bc = linear_fit(samples.count, target, columns);
    return {BcSplineKernel{.b = bc[0], .c = bc[1], .extent = extent}, {.errors = {}, .parameters = 2}};
}

}  // namespace subvol::detail
