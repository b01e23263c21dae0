#include <algorithm>
#include <numeric>

#include "fit_samples.h"
#include "fit_shapes.h"
#include "least_squares.h"

namespace subvol::detail {

namespace {

constexpr double kLeastLength = 0.05, kMostLength = 6;  // of what is looked for: widths and radii

/// A kernel of amplitude 1 by its one length.
using ByLength = Kernel (*)(double);

Kernel gaussian(double sigma) {
    return GaussianKernel{.sigma = sigma};
}

/// A sum of amplitude·kernel(length): lengths are searched for, amplitudes follow from them.
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

FitReport report_of(const Minimum& minimum, int parameters) {
    return {.errors = {}, .parameters = parameters, .iterations = minimum.iterations, .converged = minimum.converged};
}

Minimum minimize(const ScaledSum& sum, const std::vector<double>& start) {
    return minimize_squares(start, kLeastLength, kMostLength, sum.samples.size(),
                            [&](std::span<const double> lengths, std::span<double> to) { sum.residuals(lengths, to); });
}

/// Length and amplitude of one term.
struct OneTerm {
    double length, amplitude;
    FitReport report;
};

OneTerm fit_one_term(const BasisFunction& basis, ByLength kernel, double start) {
    const ScaledSum sum{radial_samples(basis), kernel};
    const Minimum minimum = minimize(sum, {start});
    return {minimum.parameters[0], sum.amplitudes(minimum.parameters)[0], report_of(minimum, 2)};
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
    const Minimum minimum = minimize_squares({0.5}, kLeastLength, kMostLength, samples.size(), residuals);
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
    std::vector<double> start;
    for (int i = 0; i < terms; ++i) start.push_back(0.45 * std::pow(1.6, i));
    Minimum minimum = minimize(sum, start);
    std::sort(minimum.parameters.begin(), minimum.parameters.end());
    return {GaussianSumKernel{.amplitudes = sum.amplitudes(minimum.parameters), .sigmas = minimum.parameters},
            report_of(minimum, 2 * terms)};
}

KernelFit fit_separable_gaussian(const BasisFunction& basis) {
    const std::size_t last = fit_last(basis);
    const auto kernel = [](std::span<const double> p) { return SeparableGaussianKernel{.a = p[1], .b = p[2], .sigma = p[0]}; };
    const auto residuals = [&](std::span<const double> p, std::span<double> to) {
        std::vector<double> line;
        for (std::size_t i = 0; i <= last; ++i) {
            const double x = fit_step(basis) * static_cast<double>(i);
            line.push_back(x < kFitReach ? (p[1] + p[2] * x * x) * std::exp(-x * x / (2 * p[0] * p[0])) : 0);
        }
        std::size_t entry = 0;
        each_in_wedge(last, [&](std::size_t i, std::size_t j, std::size_t k) {
            const double error = line[i] * line[j] * line[k] - basis_at(basis, i, j, k);
            to[entry++] = std::sqrt(wedge_multiplicity(i, j, k)) * error;
        });
    };
    // a and b may have any sign: the bounds hold for all three.
    const Minimum minimum = minimize_squares({0.6, 1, -0.5}, -kMostLength, kMostLength, wedge_size(last), residuals);
    SeparableGaussianKernel result = kernel(minimum.parameters);
    result.sigma = std::abs(result.sigma);
    return {result, report_of(minimum, 3)};
}

}  // namespace subvol::detail
