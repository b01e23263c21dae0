// SPDX-License-Identifier: Apache-2.0
// Segments of irregular edges: their rules, and their constants as the documentation has them.
#include "edge_kind.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lib/subdivision/certificate/star_mesh.h"

namespace subvol::detail {
namespace edge_kind_test {

TEST(EdgeKind, RulesAreThoseOfTheDefinition) {
    for (const Scheme scheme : {Scheme::Bsxw, Scheme::CatmullClark}) {
        for (const std::size_t m : {3UL, 5UL, 6UL, 8UL}) {
            const EdgeRules rules = edge_rules(scheme, m), expected = defined_rules(scheme, m);
            for (std::size_t h = 0; h < 2; ++h) {
                EXPECT_LT((rules.halves[h] - expected.halves[h]).cwiseAbs().maxCoeff(), 1e-14) << name_of(scheme, m);
                EXPECT_LT((rules.ring[h] - expected.ring[h]).cwiseAbs().maxCoeff(), 1e-14) << name_of(scheme, m);
            }
        }
    }
}

// The constants as the documentation has them.
struct Stated {
    Scheme scheme;
    std::size_t cells;
    double across, along, slow;
};
constexpr std::array<Stated, 10> kStated{{{Scheme::Bsxw, 3, 5.63, 4.23, 0},
                                          {Scheme::Bsxw, 5, 15.4, 7.15, 2.53},
                                          {Scheme::Bsxw, 6, 18.53, 7.9, 2.41},
                                          {Scheme::Bsxw, 7, 21.52, 8.4, 2.38},
                                          {Scheme::Bsxw, 8, 24.26, 8.75, 2.39},
                                          {Scheme::CatmullClark, 3, 5.63, 4.22, 0},
                                          {Scheme::CatmullClark, 5, 15.4, 7.15, 2.53},
                                          {Scheme::CatmullClark, 6, 18.53, 7.9, 2.41},
                                          {Scheme::CatmullClark, 7, 21.52, 8.39, 2.38},
                                          {Scheme::CatmullClark, 8, 24.26, 8.73, 2.39}}};

TEST(EdgeKind, ConstantsAreThoseStated) {
    for (const Stated& stated : kStated) {
        const EdgeKind& kind = edge_kind(stated.scheme, stated.cells);
        const auto rate = [](double cosine) {  // as of Catmull-Clark surfaces
            return (5 + cosine + std::sqrt((1 + cosine) * (9 + cosine))) / 16;
        };
        const std::string name = name_of(stated.scheme, stated.cells);
        const double turn = 2 * kPi / static_cast<double>(stated.cells);
        EXPECT_NEAR(kind.rate, rate(std::cos(turn)), 1e-12) << name;
        EXPECT_NEAR(kind.slow_rate, stated.cells == 3 ? 0 : rate(std::cos(2 * turn)), 1e-12) << name;
        EXPECT_LE(kind.across, stated.across) << name;
        EXPECT_LE(kind.along, stated.along) << name;
        EXPECT_GT(kind.across, stated.across - 0.01) << name;
        EXPECT_GT(kind.along, stated.along - 0.01) << name;
        EXPECT_LE(kind.slow_size, stated.slow) << name;
        EXPECT_GE(kind.slow_size, stated.slow - 0.01) << name;
    }
    EXPECT_FALSE(edge_kind(Scheme::Bsxw, 9).is_bounded());
}

// No weight may be off by 1e-9.
TEST(EdgeKind, OtherRulesHaveNoConstants) {
    const EdgeRules rules = edge_rules(Scheme::CatmullClark, 5);
    ASSERT_TRUE(make_edge_kind(rules).is_bounded());
    std::mt19937 dice(4);
    for (int k = 0; k < 200; ++k) {
        EdgeRules other = rules;
        MatrixXd& rows = k % 4 == 3 ? other.ring[dice() % 2] : other.halves[dice() % 2];
        rows(static_cast<Eigen::Index>(dice()) % rows.rows(), static_cast<Eigen::Index>(dice()) % rows.cols()) += 1e-9;
        EXPECT_FALSE(make_edge_kind(other).is_bounded());
    }
}

}  // namespace edge_kind_test
}  // namespace subvol::detail
