// SPDX-License-Identifier: Apache-2.0
#include "bernstein.h"

#include <gtest/gtest.h>

#include <random>

namespace subvol::detail {
namespace bernstein_test {

BernsteinColumns random_columns(std::mt19937& dice, const std::array<std::array<int, 3>, 3>& degrees) {
    std::uniform_real_distribution<double> number(-1, 1);
    BernsteinColumns columns;
    for (std::size_t c = 0; c < 3; ++c) {
        columns[c].degree = degrees[c];
        const auto n = columns[c].size();
        for (std::size_t k = 0; k < n[0] * n[1] * n[2]; ++k)
            columns[c].values.emplace_back(number(dice), number(dice), number(dice));
    }
    return columns;
}

Bernstein<Vec3> as_vectors(const Bernstein<double>& p) {
    Bernstein<Vec3> result{p.degree, {}};
    for (const double value : p.values) result.values.emplace_back(value, 0, 0);
    return result;
}

TEST(Bernstein, DeterminantsAndHalvesAreThoseOfTheValues) {
    std::mt19937 dice(1);
    std::uniform_real_distribution<double> place(0, 1);
    for (const auto& degrees : {std::array{std::array{2, 2, 2}, std::array{2, 2, 2}, std::array{2, 2, 2}},
                                std::array{std::array{2, 3, 3}, std::array{3, 2, 3}, std::array{3, 3, 2}},
                                std::array{std::array{0, 1, 1}, std::array{1, 0, 1}, std::array{1, 1, 0}}}) {
        const BernsteinColumns columns = random_columns(dice, degrees);
        const Bernstein<Vec3> det = as_vectors(determinant(columns));
        const Bernstein<Vec3> upper = half(columns[0], 1, true), lower = half(columns[0], 2, false);
        for (int k = 0; k < 20; ++k) {
            const Vec3 u(place(dice), place(dice), place(dice));
            const Mat3 j(value_at(columns[0], u), value_at(columns[1], u), value_at(columns[2], u));
            EXPECT_NEAR(value_at(det, u).x, glm::determinant(j), 1e-13);
            const double apart_upper = glm::distance(value_at(upper, u), value_at(columns[0], Vec3(u.x, (1 + u.y) / 2, u.z)));
            const double apart_lower = glm::distance(value_at(lower, u), value_at(columns[0], Vec3(u.x, u.y, u.z / 2)));
            EXPECT_LT(std::max(apart_upper, apart_lower), 1e-14);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            const auto halves = values_at_halves(columns[c]);
            for (std::size_t k = 0; k < 27; ++k) {
                const Vec3 u =
                    0.5 * Vec3(static_cast<double>(k / 9), static_cast<double>(k / 3 % 3), static_cast<double>(k % 3));
                EXPECT_LT(glm::distance(halves[k], value_at(columns[c], u)), 1e-14);
            }
        }
        EXPECT_EQ(det.corner(1, 0, 1),
                  det.values[(static_cast<std::size_t>(det.degree[0]) * (static_cast<std::size_t>(det.degree[1]) + 1)) *
                                 (static_cast<std::size_t>(det.degree[2]) + 1) +
                             static_cast<std::size_t>(det.degree[2])]);
    }
}

}  // namespace bernstein_test
}  // namespace subvol::detail
