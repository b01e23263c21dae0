// SPDX-License-Identifier: Apache-2.0
#include "subvol/fit_kernel.h"

#include "fit_samples.h"
#include "fit_shapes.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

namespace {

KernelFit fit_shape(const BasisFunction& basis, KernelShape shape, const FitOptions& options) {
    switch (shape) {
        case KernelShape::Gaussian:
            return detail::fit_gaussian(basis);
        case KernelShape::ScaledGaussian:
            return detail::fit_scaled_gaussian(basis);
        case KernelShape::BcSpline:
        case KernelShape::CardinalSpline:
            return detail::fit_cubic(basis, shape, options);
        case KernelShape::WendlandC2:
            return detail::fit_wendland_c2(basis);
        case KernelShape::WendlandC4:
            return detail::fit_wendland_c4(basis);
        case KernelShape::GaussianSum:
            return detail::fit_gaussian_sum(basis, options.terms);
        case KernelShape::SeparableGaussian:
            return detail::fit_separable_gaussian(basis);
        case KernelShape::SeparableTable:
            break;
    }
    return detail::fit_separable_table(basis);
}

}  // namespace

KernelFit fit_kernel(const BasisFunction& basis, KernelShape shape, const FitOptions& options) {
    check_options(options);
    KernelFit fit = fit_shape(basis, shape, options);
    fit.report.errors = kernel_errors(basis, fit.kernel);
    return fit;
}

std::vector<Option> options_of(FitOptions& options) {
    return {Option("extent", options.extent)
                .between(1e-3, detail::kFitReach)
                .help("R", "the distance at which bc and cardinal end"),
            Option("terms", options.terms).between(1, 6).help("N", "number of gaussians in a sum"),
            Option("sign-slip", options.sign_slip)
                .help("fit bc with the sign error of the paper's fits in the inner cubic coefficient")};
}

}  // namespace subvol
