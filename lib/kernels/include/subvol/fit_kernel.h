// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/basis_function.h"
#include "subvol/kernel.h"
#include "subvol/names.h"
#include "subvol/option_names.h"

namespace subvol {

// How well kernels approximate a scheme's basis function. All errors are over the basis function's lattice in [−3,3]³, whatever
// its support: 193³ samples at level 5, as in [mnmq2007].

struct FitErrors {
    double mse = 0;
    double rmse = 0;
    double mae = 0;
    double max = 0;
};

/// Errors of a kernel, in double precision.
///
/// cost: O(8^level): 10 ms at level 5
[[nodiscard]] FitErrors kernel_errors(const BasisFunction& basis, const Kernel& kernel);

/// The same as [mnmq2007] summed them: kernel and basis function rounded to float, and float sums one sample after the other.
/// They lose .1 to 1 % of the sum.
[[nodiscard]] FitErrors kernel_errors_float32(const BasisFunction& basis, const Kernel& kernel);

/// Errors of the best function of the distance alone: no radial kernel has a smaller mse. Its mae and max are not the smallest.
[[nodiscard]] FitErrors radial_bound(const BasisFunction& basis);

/// Gaussian: of amplitude 1; ScaledGaussian: amplitude free; SeparableTable: one value a sample interval of the basis function
enum class KernelShape {
    Gaussian,
    ScaledGaussian,
    BcSpline,
    CardinalSpline,
    WendlandC2,
    WendlandC4,
    GaussianSum,
    SeparableGaussian,
    SeparableTable
};

template <>
struct NameTable<KernelShape> {
    static constexpr Name<KernelShape> rows[] = {{KernelShape::Gaussian, "gaussian"},
                                                 {KernelShape::ScaledGaussian, "scaled_gaussian"},
                                                 {KernelShape::BcSpline, "bc"},
                                                 {KernelShape::CardinalSpline, "cardinal"},
                                                 {KernelShape::WendlandC2, "wendland_c2"},
                                                 {KernelShape::WendlandC4, "wendland_c4"},
                                                 {KernelShape::GaussianSum, "gaussians"},
                                                 {KernelShape::SeparableGaussian, "separable_gaussian"},
                                                 {KernelShape::SeparableTable, "separable_table"}};
};

struct FitOptions {
    double extent = 2;  ///< extent of the cubics in (0,3]; their pieces meet at half of it
    /// Fit B and C with 2 + 3/2·B − C as the inner cubic coefficient instead of 2 − 3/2·B − C, which explains the values that
    /// [mnmq2007] prints. Errors are those of the correct kernel
    bool sign_slip = false;
    int terms = 2;  ///< terms of a sum of Gaussians, 1 to 6; each is at least 1.25 times as wide as the one before
};

[[nodiscard]] std::vector<Option> options_of(FitOptions& options);

struct FitReport {
    FitErrors errors;
    int parameters = 0;  ///< how many numbers were fitted
    int iterations = 0;  ///< iterations of the search for the nonlinear ones, else 0
    bool converged = true;
};

struct KernelFit {
    Kernel kernel;
    FitReport report;
};

/// The kernel of a shape with the least mean squared error. Kernels of infinite support are cut off at 3. Widths and radii are
/// searched from one start: a sum of more than two Gaussians may be a local optimum.
///
/// throws: Error(InvalidInput) if an option is out of range, or for a table if the basis function is above level 6
/// cost:   at level 5 below 1 s each
/// source: linear parameters by least squares, the others by Levenberg-Marquardt with the linear ones projected out
[[nodiscard]] KernelFit fit_kernel(const BasisFunction& basis, KernelShape shape, const FitOptions& options = {});

/// Σ core(p,q,r) f_p(|x|) f_q(|y|) f_r(|z|), one set of factors for the three axes.
struct TuckerFit {
    int rank = 0;
    std::vector<double> factors;  ///< factor p at i/2^level is entry p·(3·2^level + 1) + i
    std::vector<double> core;     ///< rank³ numbers, p fastest
    FitReport report;
};

/// throws: Error(InvalidInput) if the rank is not 1 to 16, or the basis function is above level 6
/// source: higher-order orthogonal iteration from the higher-order singular value decomposition (De Lathauwer et al. 2000)
[[nodiscard]] TuckerFit fit_tucker(const BasisFunction& basis, int rank);

}  // namespace subvol
