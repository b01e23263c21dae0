// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/compositor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace subvol {

using namespace detail;
namespace compositor_test {

struct Stretch {
    double front, back, length;
};

// Colour and opacity knots at different values, transparent stretches, a narrow peak and a nearly opaque end.
TransferFunction sharp() {
    return {{{0.0, {1, 0, 0}}, {0.3, {0, 1, 0.2}}, {0.55, {0.1, 0.2, 1}}, {1.0, {1, 1, 0.5}}},
            {{0.1, 0.0}, {0.4, 0.02}, {0.42, 0.6}, {0.44, 0.0}, {0.6, 0.0}, {0.8, 0.3}, {1.0, 1.0}}};
}

Segment one_by_one(const Optics& optics, const std::vector<Stretch>& stretches) {
    Segment light;
    for (const auto& [front, back, length] : stretches) composite(light, optics.integrate(front, back, length));
    return light;
}

Segment at_once(Compositor& compositor, const std::vector<Stretch>& stretches) {
    compositor.start({});
    for (const auto& [front, back, length] : stretches) compositor.add(front, back, length);
    return compositor.finish();
}

// The error of both is 1e-11 of the light that a piece absorbs, and all pieces together absorb at most 1.
constexpr double kTol = 1e-11;

void expect_near(const Segment& a, const Segment& b, double tolerance) {
    EXPECT_NEAR(a.transmittance, b.transmittance, tolerance);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a.color[c], b.color[c], tolerance);
}

TEST(Compositor, IsIntegrateOfEachStretch) {
    const Optics optics(sharp(), 0.31);
    Compositor compositor(optics);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> start(-0.2, 1.2), log_step(-6, 0), log_length(-6, 1), sign(-1, 1);
    for (int ray = 0; ray < 2000; ++ray) {
        std::vector<Stretch> stretches;
        double value = start(random);
        const double step = std::pow(10, log_step(random)), length = std::pow(10, log_length(random));
        for (int i = 0; i < ray % 150; ++i) {
            const double next = value + step * sign(random);
            stretches.push_back({value, next, length * std::abs(sign(random))});
            value = next;
        }
        expect_near(at_once(compositor, stretches), one_by_one(optics, stretches), kTol);
        if (HasFailure()) FAIL() << "ray " << ray << " of " << stretches.size() << " stretches";
    }
}

TEST(Compositor, WhatWasBeforeChangesNoBit) {
    const Optics optics(sharp(), 0.31);
    Compositor used(optics);
    std::mt19937 random(9);
    std::uniform_real_distribution<double> value(-0.2, 1.2), log_length(-4, 0);
    for (int ray = 0; ray < 500; ++ray) {
        std::vector<Stretch> stretches;
        for (int i = 0; i < ray % 40; ++i) {
            const double from = value(random);
            stretches.push_back({from, from + 0.01, std::pow(10, log_length(random))});
        }
        Compositor fresh(optics);
        const Segment a = at_once(used, stretches), b = at_once(fresh, stretches);
        ASSERT_EQ(std::memcmp(&a, &b, sizeof(Segment)), 0) << "ray " << ray;
    }
}

TEST(Compositor, ThinAndDeepPiecesKeepTheirRelativeError) {
    for (const double alpha : {1e-9, 1e-3, 0.3, 0.999}) {
        const Optics optics({{{0, {1, .5, .25}}, {1, {0, .5, 1}}}, {{0, 0.9 * alpha}, {1, alpha}}}, 2.0);
        Compositor compositor(optics);
        for (const double length : {1e-9, 1e-5, 1e-2, 0.1, 0.5, 1.0, 10.0, 1e6}) {
            const Segment exact = optics.integrate(0.2, 0.25, length);
            const Segment seen = at_once(compositor, {{0.2, 0.25, length}});
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen.color[c] / exact.color[c], 1, kTol) << alpha << ' ' << length;
            // 1 − T, rounded.
            EXPECT_NEAR(1 - seen.transmittance, 1 - exact.transmittance, kTol * (1 - exact.transmittance) + 3e-16);
        }
    }
}

TEST(Compositor, KnotsAreCutInBothDirections) {
    const Optics optics(sharp(), 0.2);
    Compositor compositor(optics);
    for (const auto& stretch : {Stretch{-1, 2, 0.3}, {2, -1, 0.3}, {0.3, 0.42, 0.1}, {0.42, 0.3, 0.1}, {0.42, 0.42, 0.1}}) {
        expect_near(at_once(compositor, {stretch}), optics.integrate(stretch.front, stretch.back, stretch.length), kTol);
    }
}

TEST(Compositor, NothingIsSeenThroughTransparentStretches) {
    const Optics optics(sharp(), 0.1);
    Compositor compositor(optics);
    const Segment seen = at_once(compositor, std::vector<Stretch>(500, {0.45, 0.59, 1e9}));
    EXPECT_EQ(seen.transmittance, 1);
    EXPECT_EQ(seen.color, Vec3(0.0));
}

TEST(Compositor, GoesOnBehindWhatIsInFrontAndStopsWhereLightIsUsedUp) {
    const Optics optics(sharp(), 0.5);
    Compositor compositor(optics, 1e-6);
    const Segment front{{.1, .2, .3}, .25};
    compositor.start(front);
    compositor.add(0.65, 0.7, 0.4);
    Segment expected = front;
    composite(expected, optics.integrate(0.65, 0.7, 0.4));
    expect_near(compositor.finish(), expected, kTol);

    compositor.start({});
    EXPECT_FALSE(compositor.opaque());
    std::size_t added = 0;
    for (; !compositor.opaque() && added < 1000; ++added) compositor.add(0.95, 0.95, 10);
    EXPECT_LT(added, 100u);  // at most a few vectors of pieces are waiting
    const Segment seen = compositor.finish();
    EXPECT_LT(seen.transmittance, 1e-6);
    EXPECT_NEAR(seen.color.b, optics.color(0.95).b, 1e-6);
}

TEST(Compositor, NotANumberComesBack) {
    const Optics optics(sharp(), 1.0);
    Compositor compositor(optics);
    const double nan = std::nan("");
    EXPECT_TRUE(std::isnan(at_once(compositor, {{nan, nan, 1.0}}).transmittance));
    EXPECT_EQ(at_once(compositor, {{0.7, 0.7, 0.0}}).transmittance, 1);
    EXPECT_EQ(at_once(compositor, {{0.7, 0.7, std::numeric_limits<double>::infinity()}}).transmittance, 0);
}

}  // namespace compositor_test
}  // namespace subvol
