// SPDX-License-Identifier: Apache-2.0
#include "subvol/fit_kernel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"

namespace subvol {
namespace fit_kernel_test {

const BasisFunction& mcq() {
    static const BasisFunction basis = sample_basis_function(Scheme::Mcq, 5);
    return basis;
}

BcSplineKernel bc(double b, double c, double extent) {
    return {.b = b, .c = c, .extent = extent};
}

struct Row {
    const char* name;
    Kernel kernel;
    double paper_mse, paper_rmse, paper_mae;
    double float_rmse, float_mae, rmse, mae;
};

// Table 1 of [mnmq2007] with its parameters; the errors in float and double are those of an independent prototype.
const Row kTable1[] = {
    {"Gauss", GaussianKernel{.sigma = .43}, .000041, .006395, .002079, .006394634, .002079396, .00640214, .00209059},
    {"BC 1", bc(.382175, .253253, 1), .000054, .007339, .002144, .007338505, .002144303, .00734595, .00215553},
    {"BC 2", bc(.039579, .028746, 2), .000139, .011808, .002892, .011808286, .002892460, .01181898, .00291565},
    {"BC 3", bc(-.062800, .012591, 3), .011781, .108542, .022184, .108541697, .022183823, .10864744, .02229304},
    {"Cardinal 1", CardinalSplineKernel{-.507829, 1}, .000127, .011275, .002895, .011274548, .002894728, .01128543, .00291803},
    {"Cardinal 2", CardinalSplineKernel{-.098673, 2}, .000156, .012492, .002944, .012492324, .002943675, .01251482, .00296735},
    {"Cardinal 3", CardinalSplineKernel{-.040698, 3}, .010297, .101472, .028730, .101471681, .028730233, .10179878, .02884056},
};

TEST(FitKernel, ErrorsOfTable1InDoublePrecision) {
    for (const Row& row : kTable1) {
        const FitErrors errors = kernel_errors(mcq(), row.kernel);
        EXPECT_NEAR(errors.rmse, row.rmse, 1e-7) << row.name;  // eight printed digits; the paper's parameters have six
        EXPECT_NEAR(errors.mae, row.mae, 1e-7) << row.name;
        EXPECT_DOUBLE_EQ(errors.rmse * errors.rmse, errors.mse) << row.name;
    }
}

TEST(FitKernel, FloatSumsGiveEveryDigitThatThePaperPrints) {
    for (const Row& row : kTable1) {
        const FitErrors errors = kernel_errors_float32(mcq(), row.kernel);
        EXPECT_NEAR(errors.rmse, row.paper_rmse, 1e-6) << row.name;  // its last digit
        EXPECT_NEAR(errors.mae, row.paper_mae, 1e-6) << row.name;
        EXPECT_NEAR(errors.mse, row.paper_mse, 1e-6) << row.name;
        EXPECT_NEAR(errors.rmse, row.float_rmse, 2e-8) << row.name;  // float rounds at 6e-8 of the value, 7 million times
        EXPECT_NEAR(errors.mae, row.float_mae, 2e-8) << row.name;
    }
}

TEST(FitKernel, ErrorsAtLevelFour) {
    const BasisFunction basis = sample_basis_function(Scheme::Mcq, 4);
    const auto rmse = [&](const Kernel& kernel) { return kernel_errors(basis, kernel).rmse; };
    EXPECT_NEAR(rmse(kTable1[0].kernel), .006353623998, 1e-12);  // twelve printed digits
    EXPECT_NEAR(rmse(kTable1[1].kernel), .007291542431, 1e-12);
    EXPECT_NEAR(rmse(kTable1[2].kernel), .011728123135, 1e-12);
    EXPECT_NEAR(rmse(kTable1[5].kernel), .012418470182, 1e-12);
}

TEST(FitKernel, CardinalParameters) {
    const double paper[] = {-.507829, -.098673, -.040698}, ours[] = {-.507839, -.098647, -.040645};
    for (int extent = 1; extent <= 3; ++extent) {
        const KernelFit fit = fit_kernel(mcq(), KernelShape::CardinalSpline, {.extent = double(extent)});
        const double a = std::get<CardinalSplineKernel>(fit.kernel).a;
        EXPECT_NEAR(a, ours[extent - 1], 1e-5);
        EXPECT_NEAR(a, paper[extent - 1], 6e-5);  // the paper's float sums
    }
}

TEST(FitKernel, BcParametersWithTheSlipAreThePapers) {
    const double paper[][2] = {{.382175, .253253}, {.039579, .028746}, {-.062800, .012591}};
    const double ours[][2] = {{.381982, .253413}, {.039383, .029262}, {-.062718, .012994}};
    for (int extent = 1; extent <= 3; ++extent) {
        const auto fit = fit_kernel(mcq(), KernelShape::BcSpline, {.extent = double(extent), .sign_slip = true});
        const auto& kernel = std::get<BcSplineKernel>(fit.kernel);
        EXPECT_NEAR(kernel.b, ours[extent - 1][0], 1e-6) << extent;  // as printed
        EXPECT_NEAR(kernel.c, ours[extent - 1][1], 1e-6) << extent;
        EXPECT_NEAR(kernel.b, paper[extent - 1][0], 6e-4) << extent;  // float sums again
        EXPECT_NEAR(kernel.c, paper[extent - 1][1], 6e-4) << extent;
    }
}

TEST(FitKernel, BcParametersWithoutTheSlipAreBetter) {
    const double expected[][3] = {{.490705, .187922, .007077}, {.418792, .146011, .004847}, {1.213801, -.089638, .024222}};
    for (int extent = 1; extent <= 3; ++extent) {
        const KernelFit fit = fit_kernel(mcq(), KernelShape::BcSpline, {.extent = double(extent)});
        const auto& kernel = std::get<BcSplineKernel>(fit.kernel);
        EXPECT_NEAR(kernel.b, expected[extent - 1][0], 1e-6) << extent;  // as printed
        EXPECT_NEAR(kernel.c, expected[extent - 1][1], 1e-6) << extent;
        EXPECT_NEAR(fit.report.errors.rmse, expected[extent - 1][2], 6e-7) << extent;
    }
}

/// Within 2 %, or half a unit of the last printed digit.
void expect_errors(const FitErrors& errors, double rmse, double mae, double max) {
    EXPECT_NEAR(errors.rmse, rmse, .02 * rmse + 5e-6);
    EXPECT_NEAR(errors.mae, mae, .02 * mae + 5e-6);
    EXPECT_NEAR(errors.max, max, .02 * max + 5e-4);
}

TEST(FitKernel, GaussianOfThePaperAndItsBest) {
    expect_errors(kernel_errors(mcq(), GaussianKernel{.sigma = .43}), .00640, .00209, .089);
    const KernelFit fit = fit_kernel(mcq(), KernelShape::Gaussian);
    EXPECT_NEAR(std::get<GaussianKernel>(fit.kernel).sigma, .430528, 1e-6);
    EXPECT_TRUE(fit.report.converged);
    const KernelFit scaled = fit_kernel(mcq(), KernelShape::ScaledGaussian);
    EXPECT_LT(scaled.report.errors.rmse, fit.report.errors.rmse);
}

TEST(FitKernel, RadialKernels) {
    expect_errors(fit_kernel(mcq(), KernelShape::BcSpline).report.errors, .00485, .00151, .140);
    const KernelFit wendland = fit_kernel(mcq(), KernelShape::WendlandC2);
    expect_errors(wendland.report.errors, .00509, .00176, .075);
    EXPECT_NEAR(std::get<WendlandC2Kernel>(wendland.kernel).radius, 1.64572, 1e-4);  // a flat minimum: 1e-4 off, 1e-9 worse
    EXPECT_NEAR(std::get<WendlandC2Kernel>(wendland.kernel).amplitude, .92666, 1e-4);
    const KernelFit two = fit_kernel(mcq(), KernelShape::GaussianSum);
    expect_errors(two.report.errors, .00423, .00136, .146);
    const auto& sum = std::get<GaussianSumKernel>(two.kernel);
    EXPECT_NEAR(sum.sigmas.at(0), .5015, .02 * .5015);
    EXPECT_NEAR(sum.sigmas.at(1), .74912, .02 * .74912);
    EXPECT_NEAR(sum.amplitudes.at(0), 1.01121, .02 * 1.01121);
    EXPECT_NEAR(sum.amplitudes.at(1), -.15767, .02 * .15767);
}

TEST(FitKernel, NoRadialKernelIsBetterThanTheBound) {
    const FitErrors bound = radial_bound(mcq());
    expect_errors(bound, .00387, .00109, .078);
    for (const auto shape : {KernelShape::ScaledGaussian, KernelShape::BcSpline, KernelShape::WendlandC2,
                             KernelShape::WendlandC4, KernelShape::GaussianSum}) {
        const KernelFit fit = fit_kernel(mcq(), shape, {.terms = 3});
        EXPECT_GT(fit.report.errors.rmse, bound.rmse);
        EXPECT_TRUE(fit.report.converged);
    }
}

TEST(FitKernel, SeparableKernels) {
    const KernelFit gaussian = fit_kernel(mcq(), KernelShape::SeparableGaussian);
    expect_errors(gaussian.report.errors, .00327, .00120, .149);
    const auto& kernel = std::get<SeparableGaussianKernel>(gaussian.kernel);
    EXPECT_NEAR(kernel.sigma, .60388, 1e-4);  // a flat minimum again
    EXPECT_NEAR(kernel.a, .94755, 1e-4);
    EXPECT_NEAR(kernel.b, -.74100, 1e-4);
    const KernelFit table = fit_kernel(mcq(), KernelShape::SeparableTable);
    expect_errors(table.report.errors, .00259, .00096, .085);
    EXPECT_EQ(std::get<SeparableTableKernel>(table.kernel).values.size(), 97u);
}

TEST(FitKernel, SumsOfSeparableKernels) {
    const double expected[] = {.00169, .00032, .00008};
    for (int rank = 2; rank <= 4; ++rank) {
        const TuckerFit fit = fit_tucker(mcq(), rank);
        EXPECT_NEAR(fit.report.errors.rmse, expected[rank - 2], .02 * expected[rank - 2] + 5e-6) << rank;
        EXPECT_EQ(fit.report.parameters, 97 * rank);
        EXPECT_TRUE(fit.report.converged) << rank;
    }
}

TEST(FitKernel, TuckerOfASeparableFunctionIsExact) {
    const BasisFunction spline = sample_basis_function(Scheme::CatmullClark, 3);
    const KernelFit fit = fit_kernel(spline, KernelShape::SeparableTable);
    EXPECT_LT(fit.report.errors.max, 1e-14);
    const auto& values = std::get<SeparableTableKernel>(fit.kernel).values;
    EXPECT_NEAR(values.at(0), 2. / 3, 1e-14);
    EXPECT_NEAR(values.at(8), 1. / 6, 1e-14);
    EXPECT_NEAR(values.at(24), 0, 1e-14);
}

TEST(FitKernel, NamedKernelsAreTheFitsOfTheirShape) {
    // Parameters are printed with five digits or more, and at a minimum the error changes with the square of their rounding.
    const auto expect_best = [](const std::string& name, KernelShape shape, double tolerance) {
        const double named = kernel_errors(mcq(), named_kernel(name)).rmse;
        const double best = fit_kernel(mcq(), shape).report.errors.rmse;
        EXPECT_NEAR(named, best, tolerance) << name;
        EXPECT_GE(named, best - 1e-12) << name;
    };
    expect_best("bc", KernelShape::BcSpline, 1e-9);
    expect_best("cardinal", KernelShape::CardinalSpline, 1e-9);
    expect_best("wendland_c2", KernelShape::WendlandC2, 1e-9);
    expect_best("wendland_c4", KernelShape::WendlandC4, 1e-9);
    expect_best("two_gaussians", KernelShape::GaussianSum, 1e-7);
    expect_best("separable_gaussian", KernelShape::SeparableGaussian, 1e-7);
    expect_best("gaussian", KernelShape::Gaussian, 1e-6);  // the paper's .43, not .430528
}

TEST(FitKernel, BadOptionsAreRefused) {
    const BasisFunction basis = sample_basis_function(Scheme::Mcq, 1);
    const auto refused = [&](const std::string& part, KernelShape shape, const FitOptions& options) {
        test::expect_error(ErrorCode::InvalidInput, part, [&] { (void)fit_kernel(basis, shape, options); });
    };
    refused("extent", KernelShape::BcSpline, {.extent = 0});
    refused("extent", KernelShape::CardinalSpline, {.extent = std::nan("")});
    refused("terms: 0 is out of range (1 to 6)", KernelShape::GaussianSum, {.terms = 0});
    test::expect_error(ErrorCode::InvalidInput, "rank is 0", [&] { (void)fit_tucker(basis, 0); });
    test::expect_error(ErrorCode::InvalidInput, "rank", [&] { (void)fit_tucker(basis, 8); });
}

}  // namespace fit_kernel_test
}  // namespace subvol
