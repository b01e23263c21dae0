// SPDX-License-Identifier: Apache-2.0
#include "subvol/kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "lib/expect_error.h"
#include "lib/kernel_samples.h"
#include "lib/random_vector.h"
#include "subvol/detail/kernel_code.h"

namespace subvol {

using namespace detail;
namespace kernel_test {

using test::every_kernel;
using test::expect_error;

// Composite Gauss-Legendre, 5 points on each of many pieces: independent of the closed forms.
double quadrature(const std::function<double(double)>& f, double a, double b, int pieces) {
    const double nodes[] = {0, 0.5384693101056831, 0.9061798459386640};
    const double weights[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    double sum = 0;
    const double half = (b - a) / (2 * pieces);
    for (int i = 0; i < pieces; ++i) {
        const double middle = a + (2 * i + 1) * half;
        sum += weights[0] * f(middle);
        for (int n = 1; n < 3; ++n) sum += weights[n] * (f(middle - half * nodes[n]) + f(middle + half * nodes[n]));
    }
    return sum * half;
}

double value_at(const Kernel& kernel, double x, double y, double z) {
    return kernel_value(kernel, {x, y, z});
}

TEST(Kernel, VanishesAtItsSupportAndNotBefore) {
    for (const auto& [name, kernel] : every_kernel()) {
        const double radius = support_radius(kernel);
        EXPECT_EQ(radial_value(kernel, radius), 0) << name;
        EXPECT_EQ(radial_value(kernel, radius + 1e-9), 0) << name;
        EXPECT_NE(radial_value(kernel, radius * (1 - 1e-4)), 0) << name;
        EXPECT_EQ(value_at(kernel, 0, 0, -radius), 0) << name;
        const double corner = value_at(kernel, 0.9 * radius, 0.9 * radius, 0);
        EXPECT_EQ(corner == 0, is_radial(kernel)) << name;
    }
}

TEST(Kernel, IsEvenAndSymmetricInTheAxes) {
    for (const auto& [name, kernel] : every_kernel()) {
        const double value = value_at(kernel, 0.3, 0.5, 0.7);
        EXPECT_NEAR(value_at(kernel, -0.7, 0.3, -0.5), value, 1e-15) << name;  // rounding: the operations are in another order
        if (!is_radial(kernel)) continue;
        EXPECT_NEAR(radial_value(kernel, std::sqrt(0.83)), value, 1e-15) << name;
    }
}

TEST(Kernel, KnownValues) {
    EXPECT_EQ(radial_value(CompactKernel{.radius = 2}, 1), 27.0 / 64);
    EXPECT_DOUBLE_EQ(radial_value(GaussianKernel{.sigma = 0.5, .amplitude = 3}, 1), 3 * std::exp(-2.0));
    const Kernel b_spline = BcSplineKernel{.b = 1, .c = 0};
    EXPECT_DOUBLE_EQ(radial_value(b_spline, 0), 4.0 / 6);
    EXPECT_DOUBLE_EQ(radial_value(b_spline, 1), 1.0 / 6);
    EXPECT_DOUBLE_EQ(radial_value(CardinalSplineKernel{.a = -0.5}, 0.5), 9.0 / 16);
    EXPECT_DOUBLE_EQ(value_at(CubicConvolutionKernel{}, 0.5, -0.5, 1.5), 9.0 / 16 * 9 / 16 * -1 / 16);
    EXPECT_DOUBLE_EQ(radial_value(WendlandC2Kernel{.radius = 2, .amplitude = 2}, 1), 2.0 / 16 * 3);
    EXPECT_DOUBLE_EQ(radial_value(WendlandC4Kernel{.radius = 2, .amplitude = 1}, 1), (35.0 / 4 + 9 + 3) / 64 / 3);
    EXPECT_DOUBLE_EQ(value_at(SeparableTableKernel{.radius = 2, .values = {1, 0.5, 0}}, 0.5, 1.5, -1), 0.75 * 0.25 * 0.5);
}

TEST(Kernel, RadiusOfTheCubicsIsTheirFullExtent) {
    const BcSplineKernel inner{.b = 0.3, .c = 0.2, .extent = 1};
    EXPECT_DOUBLE_EQ(radial_value(inner, 0.4), radial_value(BcSplineKernel{.b = 0.3, .c = 0.2}, 0.4));
    const double t = 0.6;
    EXPECT_DOUBLE_EQ(radial_value(inner, t), (-0.05 - 0.2) * t * t * t + 1.3 * t * t - 2.2 * t + 1.2);
    EXPECT_EQ(radial_value(inner, 1), 0);
}

TEST(Kernel, IsAsSmoothAsItSays) {
    const double step = 1e-6;
    const auto jump = [&](const Kernel& k, double at) { return radial_value(k, at + step) - radial_value(k, at - step); };
    const auto slope_jump = [&](const Kernel& k, double at) {
        return kernel_gradient(k, {at + step, 0, 0}).x - kernel_gradient(k, {at - step, 0, 0}).x;
    };
    for (const double at : {1.0, 2.0}) {
        for (const Kernel& kernel :
             {Kernel{BcSplineKernel{}}, Kernel{CardinalSplineKernel{}}, Kernel{CubicConvolutionKernel{}}}) {
            EXPECT_NEAR(jump(kernel, at), 0, 10 * step);        // C0: the difference falls with the step
            EXPECT_NEAR(slope_jump(kernel, at), 0, 20 * step);  // C1
        }
    }
    for (const Kernel& kernel : {Kernel{CompactKernel{}}, Kernel{WendlandC2Kernel{}}, Kernel{WendlandC4Kernel{}}}) {
        EXPECT_NEAR(jump(kernel, support_radius(kernel)), 0, step * step);
        EXPECT_NEAR(slope_jump(kernel, support_radius(kernel)), 0, 20 * step);
        EXPECT_NEAR(slope_jump(kernel, 0), 0, 40 * step);  // no cusp in the middle
    }
    EXPECT_GT(std::abs(jump(BcSplineKernel{.extent = 3}, 3)), 0.1);  // with the paper's other extents the kernel jumps
}

TEST(Kernel, GradientIsThatOfTheValue) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> anywhere(-1, 1);
    const double step = 1e-6;
    for (const auto& [name, kernel] : every_kernel()) {
        int compared = 0;
        for (int i = 0; i < 500; ++i) {
            const double reach = support_radius(kernel);
            const Vec3 x = reach * test::random_vector(anywhere, random);
            const Vec3 gradient = kernel_gradient(kernel, x);
            for (int axis = 0; axis < 3; ++axis) {
                Vec3 d(0.0);
                d[axis] = step;
                const double after = kernel_value(kernel, x + d), before = kernel_value(kernel, x - d);
                const double right = (after - kernel_value(kernel, x)) / step, left = (kernel_value(kernel, x) - before) / step;
                if (std::abs(right - left) > 1e-4) continue;  // across a kink of a table or a cut
                // Second-order differences: step² times third derivatives below 1e3, and rounding 1e-16/step.
                EXPECT_NEAR((after - before) / (2 * step), gradient[axis], 1e-8) << name << " axis " << axis;
                ++compared;
            }
        }
        EXPECT_GT(compared, 1400) << name;
    }
}

TEST(Kernel, GradientVanishesInTheMiddle) {
    for (const auto& [name, kernel] : every_kernel()) EXPECT_EQ(kernel_gradient(kernel, Vec3(0.0)), Vec3(0.0)) << name;
}

TEST(Kernel, SlabIntegralsAreThoseOfQuadrature) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> anywhere(-1.1, 1.1);
    for (const auto& [name, kernel] : every_kernel()) {
        const double reach = support_radius(kernel);
        for (int i = 0; i < 12; ++i) {
            const double x = i == 0 ? 0 : reach * anywhere(random), y = i == 0 ? 0 : reach * anywhere(random);
            const double z0 = reach * anywhere(random), z1 = reach * anywhere(random);
            const auto f = [&, &k = kernel](double z) { return value_at(k, x, y, z); };
            // Kinks fall inside pieces: the error there is piece² × the jump of the slope, or piece × the jump of the value.
            const int pieces = 20000;
            EXPECT_NEAR(slab_integral(kernel, x, y, z0, z1), quadrature(f, z0, z1, pieces),
                        test::has_jumps(kernel) ? 1e-3 : 1e-8)
                << name << " at " << x << " " << y << " from " << z0 << " to " << z1;
        }
    }
}

TEST(Kernel, SlabIntegralsAddUp) {
    std::mt19937 random(13);
    std::uniform_real_distribution<double> anywhere(-1.2, 1.2);
    for (const auto& [name, kernel] : every_kernel()) {
        const double reach = support_radius(kernel);
        for (int i = 0; i < 100; ++i) {
            const double x = reach * anywhere(random) / 2, y = reach * anywhere(random) / 2;
            const double z0 = reach * anywhere(random), z1 = reach * anywhere(random), z2 = reach * anywhere(random);
            const double parts = slab_integral(kernel, x, y, z0, z1) + slab_integral(kernel, x, y, z1, z2);
            // Rounding: the antiderivative of Wendland's C4 sums terms of about 100.
            EXPECT_NEAR(parts, slab_integral(kernel, x, y, z0, z2), 1e-12) << name;
            const double all = slab_integral(kernel, x, y, -9, z1) + slab_integral(kernel, x, y, z1, 9);
            EXPECT_NEAR(all, line_integral(kernel, x, y), 1e-12) << name;
            EXPECT_NEAR(slab_integral(kernel, x, y, -z1, -z0), slab_integral(kernel, x, y, z0, z1), 1e-12) << name;
        }
        EXPECT_EQ(slab_integral(kernel, 0.1, 0.2, 5, 6), 0) << name;
        EXPECT_EQ(line_integral(kernel, 5, 0), 0) << name;
        EXPECT_EQ(line_integral(kernel, 0, reach), 0) << name;
    }
}

TEST(Kernel, LineIntegralOfAGaussianIsTheTextbooks) {
    const Kernel kernel = GaussianKernel{.sigma = 0.4, .amplitude = 2, .radius = 9};
    EXPECT_NEAR(line_integral(kernel, 0.3, 0.4), 2 * std::exp(-0.25 / 0.32) * 0.4 * std::sqrt(2 * M_PI), 1e-15);
}

TEST(Kernel, JsonReadsBackBitForBit) {
    for (const auto& [name, kernel] : every_kernel()) {
        const Kernel back = kernel_from_json(to_json(kernel));
        ASSERT_EQ(back.index(), kernel.index()) << name;
        const KernelCode one = kernel_code(kernel), two = kernel_code(back);
        EXPECT_EQ(one.parameters, two.parameters) << name;
        EXPECT_EQ(one.table, two.table) << name;
    }
}

TEST(Kernel, JsonLeftOutTakesTheDefault) {
    const Kernel kernel = kernel_from_json(R"({"type": "gaussian", "sigma": 0.5})");
    EXPECT_EQ(std::get<GaussianKernel>(kernel).sigma, 0.5);
    EXPECT_EQ(std::get<GaussianKernel>(kernel).radius, GaussianKernel{}.radius);
}

TEST(Kernel, BadJsonIsRefusedInASentence) {
    constexpr auto kInvalid = ErrorCode::InvalidInput;
    const auto refused = [](const std::string& text, const std::string& part) {
        expect_error(kInvalid, part, [&] { (void)kernel_from_json(text); });
    };
    refused("", "JSON");
    refused("{", "JSON");
    refused("[1]", "not an object");
    refused("{}", "'type'");
    refused(R"({"type": 3})", "'type'");
    refused(R"({"type": "gauss"})", "there is no type 'gauss'");
    refused(R"({"type": "gaussian", "sigm": 1})", "no field 'sigm'");
    refused(R"({"type": "gaussian", "sigma": "1"})", "'sigma' is not a number");
    refused(R"({"type": "gaussian", "sigma": 0})", "'sigma' is 0");
    refused(R"({"type": "gaussian", "sigma": 1e999})", "JSON");
    refused(R"({"type": "gaussian", "radius": -1})", "positive");
    refused(R"({"type": "gaussian_sum", "sigmas": [1, 2], "amplitudes": [1]})", "pair");
    refused(R"({"type": "gaussian_sum"})", "pair");
    refused(R"({"type": "separable_table", "values": [1]})", "1 values per axis");
    refused(R"({"type": "table", "count": 2, "values": [1, 2, 3]})", "3 values");
    refused(R"({"type": "table", "count": 4294967296, "values": [1]})", "per axis");
    refused(R"({"type": "table", "count": -2, "values": [1]})", "non-negative integer");
    refused(R"({"type": "table", "values": {"a": 1}})", "not an array");
}

TEST(Kernel, WhatIsNotValidIsNotWritten) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    expect_error(ErrorCode::InvalidInput, "finite", [&] { (void)to_json(GaussianKernel{.amplitude = nan}); });
    expect_error(ErrorCode::InvalidInput, "finite", [&] { (void)kernel_code(GaussianKernel{.amplitude = nan}); });
}

TEST(Kernel, EveryNameIsAValidKernel) {
    for (const std::string& name : kernel_names()) EXPECT_NO_THROW(validate(named_kernel(name))) << name;
    EXPECT_EQ(kernel_names().size(), 10u);
    expect_error(ErrorCode::InvalidInput, "no kernel 'sinc'", [] { (void)named_kernel("sinc"); });
}

}  // namespace kernel_test
}  // namespace subvol
