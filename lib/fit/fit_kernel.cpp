// SPDX-License-Identifier: Apache-2.0
#include "subvol/fit_kernel.h"

#include "fit_samples.h"
#include "fit_shapes.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol {

namespace {

void check(const FitOptions& options) {
    if (!(options.extent > 0 && options.extent <= detail::kFitReach)) {
        throw Error(ErrorCode::InvalidInput, "the extent of a cubic is " + detail::number_text(options.extent), {},
                    "above 0, to 3");
    }
    if (options.terms < 1 || options.terms > 6) {
        throw Error(ErrorCode::InvalidInput, "the number of Gaussians is " + std::to_string(options.terms), {}, "1 to 6");
    }
}

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
    check(options);
    KernelFit fit = fit_shape(basis, shape, options);
    fit.report.errors = kernel_errors(basis, fit.kernel);
    return fit;
}

}  // namespace subvol
