// SPDX-License-Identifier: Apache-2.0
#include "distortion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "subvol/cell.h"

namespace subvol::detail {
namespace distortion_test {

CornerCoordinates unit_cube() {
    CornerCoordinates cube{};
    for (std::size_t k = 0; k < 8; ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) cube[axis][k] = kCornerParameters[k][axis];
    }
    return cube;
}

CornerCoordinates moved(const CornerCoordinates& from, double size) {
    std::mt19937 dice(3);
    std::uniform_real_distribution<double> noise(-size, size);
    CornerCoordinates corners = from;
    for (auto& axis : corners) {
        for (double& x : axis) x += noise(dice);
    }
    return corners;
}

double value_of(const CornerCoordinates& corners, double epsilon) {
    CornerCoordinates slopes;
    return distortion_of(corners, epsilon, slopes);
}

// Each of the eight corners has |J|² = 3 and D = 1, and any way from there makes it worse.
TEST(Distortion, IsLeastForACube) {
    CornerCoordinates slopes;
    EXPECT_NEAR(distortion_of(unit_cube(), 0, slopes), 8 * (3 + 1), 1e-12);
    for (const auto& axis : slopes) {
        for (const double slope : axis) EXPECT_NEAR(slope, 0, 1e-12);
    }
    for (const double size : {0.01, 0.1, 0.3}) EXPECT_GT(value_of(moved(unit_cube(), size), 0), 32);
}

TEST(Distortion, SlopesAreThoseOfTheValue) {
    constexpr double kStep = 1e-6;
    for (const double epsilon : {0.0, 0.2}) {
        CornerCoordinates corners = moved(unit_cube(), 0.2), slopes, unused;
        (void)distortion_of(corners, epsilon, slopes);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (std::size_t k = 0; k < 8; ++k) {
                const double at = corners[axis][k];
                corners[axis][k] = at + kStep;
                const double above = distortion_of(corners, epsilon, unused);
                corners[axis][k] = at - kStep;
                const double below = distortion_of(corners, epsilon, unused);
                corners[axis][k] = at;
                EXPECT_NEAR(slopes[axis][k], (above - below) / (2 * kStep), 1e-6);
            }
        }
    }
}

// Turned inside out, a cell has a finite distortion that falls on the way back.
TEST(Distortion, OfATurnedCellIsFiniteWithEpsilon) {
    CornerCoordinates turned = unit_cube();
    std::swap(turned[0], turned[1]);
    EXPECT_TRUE(std::isfinite(value_of(turned, 0.1)));
    EXPECT_FALSE(std::isfinite(value_of(turned, 0)));
    CornerCoordinates flatter = turned;
    for (double& x : flatter[2]) x *= 0.5;
    EXPECT_LT(value_of(flatter, 0.1), value_of(turned, 0.1));
}

}  // namespace distortion_test
}  // namespace subvol::detail
