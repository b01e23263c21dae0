// SPDX-License-Identifier: Apache-2.0
#include "flatness.h"

#include <gtest/gtest.h>

#include <random>

#include "subvol/cell.h"
#include "subvol/mesh_report.h"

namespace subvol::detail {
namespace flatness_test {

CornerCoordinates noisy_cube(double size) {
    std::mt19937 dice(7);
    std::uniform_real_distribution<double> noise(-size, size);
    CornerCoordinates cube{};
    for (std::size_t k = 0; k < 8; ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) cube[axis][k] = kCornerParameters[k][axis] + noise(dice);
    }
    return cube;
}

std::array<Vec3, 8> points_of(const CornerCoordinates& corners) {
    std::array<Vec3, 8> points;
    for (std::size_t k = 0; k < 8; ++k) points[k] = {corners[0][k], corners[1][k], corners[2][k]};
    return points;
}

TEST(Flatness, IsNothingWhereScaledJacobiansAreLargeEnough) {
    CornerCoordinates slopes;
    const CornerCoordinates corners = noisy_cube(0.2);
    const double least = min_scaled_jacobian(points_of(corners));
    EXPECT_EQ(flatness_of(corners, least - 1e-9, slopes), 0);
    for (const auto& axis : slopes) {
        for (const double slope : axis) EXPECT_EQ(slope, 0);
    }
    // The worst corner alone.
    EXPECT_NEAR(flatness_of(corners, least + 1e-3, slopes), std::pow(1e-3 / (least + 1e-3), 2), 1e-9);
}

// A corner whose edges lie in a plane costs 1, one that is turned over with edges at right angles (1 + 1 / s₀)².
TEST(Flatness, OfFlatAndTurnedCorners) {
    CornerCoordinates slopes, turned = noisy_cube(0);
    for (double& x : turned[2]) x = -x;
    EXPECT_NEAR(flatness_of(turned, 0.4, slopes), 8 * 3.5 * 3.5, 1e-12);
    CornerCoordinates flat = noisy_cube(0);
    for (double& x : flat[2]) x = 0;
    EXPECT_EQ(flatness_of(flat, 0.4, slopes), 0);  // without a length there is no direction
    for (std::size_t k = 4; k < 8; ++k) flat[0][k] += 1;
    EXPECT_NEAR(flatness_of(flat, 0.4, slopes), 8, 1e-12);
}

TEST(Flatness, SlopesAreThoseOfTheValue) {
    constexpr double kStep = 1e-6;
    CornerCoordinates corners = noisy_cube(0.45), slopes, unused;
    ASSERT_GT(flatness_of(corners, 0.9, slopes), 0.5);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t k = 0; k < 8; ++k) {
            const double at = corners[axis][k];
            corners[axis][k] = at + kStep;
            const double above = flatness_of(corners, 0.9, unused);
            corners[axis][k] = at - kStep;
            const double below = flatness_of(corners, 0.9, unused);
            corners[axis][k] = at;
            EXPECT_NEAR(slopes[axis][k], (above - below) / (2 * kStep), 1e-6);
        }
    }
}

}  // namespace flatness_test
}  // namespace subvol::detail
