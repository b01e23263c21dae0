// SPDX-License-Identifier: Apache-2.0
#include "subvol/optics.h"
#include "subvol/detail/preintegrated_table.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "subvol/error.h"

namespace subvol {

using namespace detail;
namespace optics_test {

TransferFunction constant(const Vec3& rgb, double alpha) {
    return {{{0.0, rgb}}, {{0.0, alpha}}};
}

// Colour and opacity knots at different values, transparent stretches, a narrow peak and a nearly opaque end.
TransferFunction sharp() {
    return {{{0.0, {1, 0, 0}}, {0.3, {0, 1, 0.2}}, {0.55, {0.1, 0.2, 1}}, {1.0, {1, 1, 0.5}}},
            {{0.1, 0.0}, {0.4, 0.02}, {0.42, 0.6}, {0.44, 0.0}, {0.6, 0.0}, {0.8, 0.3}, {1.0, 1.0}}};
}

// The emission–absorption integral by midpoints, independent of the closed forms.
Segment brute_force(const Optics& optics, double front, double back, double length, int steps) {
    Segment total;
    const double step = length / steps;
    double depth = 0;
    for (int i = 0; i < steps; ++i) {
        const double value = front + (back - front) * (i + 0.5) / steps;
        const double own = optics.extinction(value) * step;
        total.color += std::exp(-depth) * -std::expm1(-own) * optics.color(value);
        depth += own;
    }
    total.transmittance = std::exp(-depth);
    return total;
}

void expect_near(const Segment& a, const Segment& b, double tolerance) {
    EXPECT_NEAR(a.transmittance, b.transmittance, tolerance);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a.color[c], b.color[c], tolerance);
}

TEST(Optics, ExtinctionFollowsOpacityPerUnit) {
    const Optics optics(sharp(), 0.25);
    EXPECT_NEAR(optics.extinction(0.42), -std::log(0.4) / 0.25, 1e-12);
    EXPECT_NEAR(optics.extinction(0.43), -std::log(0.7) / 0.25, 1e-12);  // α, not τ, is linear
    EXPECT_NEAR(optics.extinction(2.0), -std::log(1e-6) / 0.25, 1e-6);   // α = 1 is clamped to 1 − 1e-6
    EXPECT_EQ(optics.extinction(-1.0), 0);
    EXPECT_NEAR(optics.color(0.15).g, 0.5, 1e-15);
    EXPECT_NEAR(glm::length(optics.color(9.0) - Vec3(1, 1, 0.5)), 0, 1e-15);
}

TEST(Optics, ConstantFunctionIsBeerLambert) {
    const Vec3 rgb(0.9, 0.5, 0.1);
    const Optics optics(constant(rgb, 0.3), 2.0);
    for (const double length : {1e-9, 1e-3, 0.5, 7.0, 100.0, 1e6, 1e300}) {
        const Segment s = optics.integrate(-4, 17, length);
        const double alpha = -std::expm1(length / 2 * std::log1p(-0.3));
        // 1e-11 relative: the polynomial of the exponential and three-point quadrature.
        EXPECT_NEAR(1 - s.transmittance, alpha, 1e-11 * alpha + 1e-16) << length;
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(s.color[c], rgb[c] * alpha, 1e-11 * alpha) << length;
    }
}

TEST(Optics, TransparentStretchLetsAllLightPass) {
    const Optics optics(sharp(), 0.1);
    const Segment s = optics.integrate(0.45, 0.59, 1e9);
    EXPECT_EQ(s.transmittance, 1);
    EXPECT_EQ(s.color, Vec3(0.0));
}

TEST(Optics, MatchesBruteForceOnASharpFunction) {
    // Midpoints of 1e6 steps err by about (step · slope)²: 1e-9 where τ·L is moderate.
    const Optics optics(sharp(), 0.7);
    for (const auto& [front, back, length] : {std::array{0.0, 0.9, 2.0},
                                              {0.9, 0.0, 2.0},
                                              {0.35, 0.5, 0.5},
                                              {0.41, 0.415, 3.0},
                                              {0.41, 0.43, 0.1},
                                              {0.7, 0.7, 1.3},
                                              {0.65, 0.95, 10.0},
                                              {-1.0, 0.7, 4.0}}) {
        SCOPED_TRACE(testing::Message() << front << " to " << back << " over " << length);
        expect_near(optics.integrate(front, back, length), brute_force(optics, front, back, length, 1'000'000), 2e-9);
    }
    // Up to the clamped α = 1 the extinction has a logarithmic peak, which midpoints see to 1e-6 only.
    expect_near(optics.integrate(0.9, 1.1, 0.2), brute_force(optics, 0.9, 1.1, 0.2, 1'000'000), 1e-6);
}

TEST(Optics, SplittingAStretchChangesNothing) {
    const Optics optics(sharp(), 0.31);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> value(-0.2, 1.2), part(0, 1), log_length(-4, 3);
    for (int i = 0; i < 20000; ++i) {
        const double front = value(random), back = value(random), s = part(random), length = std::pow(10, log_length(random));
        const double middle = front + s * (back - front);
        Segment two = optics.integrate(front, middle, s * length);
        composite(two, optics.integrate(middle, back, (1 - s) * length));
        expect_near(two, optics.integrate(front, back, length), 1e-10);
        if (HasFailure()) FAIL() << front << ' ' << back << ' ' << s << ' ' << length;
    }
}

/// Up to eight knots of each kind, some only 1e-4 apart, with transparent stretches.
TransferFunction random_function(std::mt19937& random) {
    std::uniform_real_distribution<double> part(0, 1);
    std::uniform_int_distribution<int> count(1, 8);
    TransferFunction function;
    double value = -0.1;
    for (int i = count(random); i > 0; --i) {
        value += std::pow(10, -4 + 4 * part(random)) / 4;
        function.color.push_back({value, {part(random), part(random), part(random)}});
    }
    value = -0.1;
    for (int i = count(random); i > 0; --i) {
        value += std::pow(10, -4 + 4 * part(random)) / 4;
        function.opacity.push_back({value, std::max(0.0, 1.5 * part(random) - 0.5)});
    }
    return function;
}

TEST(Optics, SplittingAStretchChangesNothingForAnyFunction) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> value(-0.3, 1.3), part(0, 1), log_length(-4, 3), log_unit(-2, 1);
    for (int i = 0; i < 2000; ++i) {
        const Optics optics(random_function(random), std::pow(10, log_unit(random)));
        const double front = value(random), back = value(random), length = std::pow(10, log_length(random));
        const Segment whole = optics.integrate(front, back, length);
        Segment parts;
        double from = 0;
        for (int k = 0; k < 4; ++k) {  // I(a,b), then I(b,c), and so on
            const double to = k == 3 ? 1 : from + part(random) * (1 - from);
            composite(parts,
                      optics.integrate(front + from * (back - front), front + to * (back - front), (to - from) * length));
            from = to;
        }
        // 1e-9: the relative error of each piece's colour.
        expect_near(parts, whole, 1e-9);
        if (HasFailure()) FAIL() << "function " << i << ": " << front << ' ' << back << ' ' << length;
    }
}

TEST(Optics, ColorStaysWithinOpacity) {
    const Optics optics(sharp(), 0.01);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> value(-0.2, 1.2), log_length(-6, 6);
    for (int i = 0; i < 20000; ++i) {
        const double front = value(random), back = value(random), length = std::pow(10, log_length(random));
        const Segment s = optics.integrate(front, back, length);
        ASSERT_GE(s.transmittance, 0);
        ASSERT_LE(s.transmittance, 1);
        for (int c = 0; c < 3; ++c) {
            ASSERT_GE(s.color[c], -1e-15);
            ASSERT_LE(s.color[c], 1 - s.transmittance + 1e-12);  // rgb ≤ 1; the quadrature's relative 1e-11
        }
    }
}

TEST(Optics, ExtinctionIntegralIsTheAntiderivative) {
    const Optics optics(sharp(), 0.5);
    EXPECT_EQ(optics.extinction_integral(0.0), 0);
    for (const auto& [from, to] : {std::pair{-0.5, 0.2}, {0.39, 0.45}, {0.41, 0.4100001}, {0.7, 0.99}, {1.0, 1.5}}) {
        const Segment s = optics.integrate(from, to, to - from);
        EXPECT_NEAR(std::exp(optics.extinction_integral(from) - optics.extinction_integral(to)), s.transmittance, 1e-11);
    }
    const Optics below(constant({1, 1, 1}, 0.5), 1.0);
    EXPECT_NEAR(below.extinction_integral(-2.0), -2 * std::log(2.0), 1e-12);
}

TEST(Optics, RefusesAnImpossibleUnit) {
    for (const double unit : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(Optics(constant({1, 1, 1}, 0.5), unit), Error);
    }
}

TEST(Optics, NotANumberComesBack) {
    const Optics optics(sharp(), 1.0);
    EXPECT_TRUE(std::isnan(optics.integrate(std::nan(""), std::nan(""), 1.0).transmittance));
}

/// The means of the channels between two values, in cells, as a splatter computes them from the table.
std::array<double, 4> means(const PreintegratedTable& table, double x0, double x1) {
    const auto row = [](double x) { return std::clamp(std::floor(x), -1.0, double{PreintegratedTable::kCells}); };
    std::array<double, 4> result{};
    for (std::size_t c = 0; c < 4; ++c) {
        const auto within = [&](double x) {
            const auto& r = table.rows[static_cast<std::size_t>(row(x) + 1)];
            const double s = x - row(x);
            return s * (double{r.mean[c]} - (1 - s) * double{r.bend[c]});
        };
        const auto prefix = [&](double x) { return table.rows[static_cast<std::size_t>(row(x) + 1)].prefix[c]; };
        result[c] = (double{table.unit[c]} * (prefix(x1) - prefix(x0)) + within(x1) - within(x0)) / (x1 - x0);
    }
    return result;
}

TEST(PreintegratedTable, MeansAreThoseOfExtinctionAndEmission) {
    const Optics optics(sharp(), 0.8);
    const PreintegratedTable table = make_preintegrated_table(optics);
    EXPECT_EQ(table.min, 0.0);
    EXPECT_EQ(table.max, 1.0);
    const double cells = PreintegratedTable::kCells;
    double most = 0;
    for (const auto& row : table.rows) most = std::max(most, double{row.mean[0]});
    using Ends = std::pair<double, double>;
    for (const auto& [x0, x1] :
         {Ends{0, cells}, Ends{1500.3, 1900.8}, Ends{1719.2, 1721.9}, Ends{3000, 4000}, Ends{1720.4, 1720.9},
          Ends{1650.9, 1651.1}, Ends{-500, 300}, Ends{4000, 5000}, Ends{-30, -20}}) {
        const double from = x0 / cells, to = x1 / cells, length = 1e-3 / most;
        const auto mean = means(table, x0, x1);
        // The table is linear within a cell: with a knot inside, its error is up to a quarter of the bend. The rest is the
        // rounding of floats and of the counts, which is 2^-31 of the sum over all cells.
        const double tolerance = 3e-4 * most;
        const double exact = (optics.extinction_integral(to) - optics.extinction_integral(from)) / (to - from);
        EXPECT_NEAR(mean[0], exact, tolerance) << x0;
        const Segment thin = optics.integrate(from, to, length);  // it absorbs at most 1e-3 / 2 of its own light
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(mean[c + 1], thin.color[static_cast<int>(c)] / length, tolerance + 5e-4 * exact) << x0;
        }
    }
}

TEST(PreintegratedTable, SmallDifferencesOfLargeIntegralsKeepTheirDigits) {
    // Faint values next to dense ones: float prefixes near 4000 would be 2.4e-4 apart, a quarter of what a faint cell adds.
    const Optics optics({.color = {{0, {1, 1, 1}}}, .opacity = {{0, .001}, {.5, .001}, {.6, .9}, {1, .9}}}, 1.0);
    const PreintegratedTable table = make_preintegrated_table(optics);
    EXPECT_NEAR(means(table, 700.25, 700.75)[0] / optics.extinction(.17), 1, 1e-6);  // float rounding of the mean
    EXPECT_NEAR(means(table, 700.25, 703.5)[0], optics.extinction(.17), double{table.unit[0]} / 3.25);  // one count
}

TEST(PreintegratedTable, OneKnotStillSpansARange) {
    const PreintegratedTable table = make_preintegrated_table(Optics(constant({0.5, 1, 0}, 0.5), 1.0));
    ASSERT_LT(table.min, table.max);
    const auto mean = means(table, -100.5, 9000);
    EXPECT_NEAR(mean[0], std::log(2.0), 1e-6);
    EXPECT_NEAR(mean[1], 0.5 * std::log(2.0), 1e-6);
    EXPECT_EQ(mean[3], 0);
}

TEST(PreintegratedTable, KnowsWhatCannotBeSeen) {
    const PreintegratedTable table = make_preintegrated_table(
        Optics({.color = {{0, {1, 1, 1}}}, .opacity = {{0, 0}, {.25, 0}, {.5, .3}, {.75, 0}, {1, 0}}}, 1.0));
    EXPECT_TRUE(table.transparent(-1e9, 1023));
    EXPECT_FALSE(table.transparent(500, 1025));
    EXPECT_FALSE(table.transparent(2000, 2000));
    EXPECT_TRUE(table.transparent(1e9, 3073));
}

}  // namespace optics_test
}  // namespace subvol
