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

// The constants as the documentation has them. Those of Catmull-Clark with 7 and 8 cells are not bounded: an eigenvalue of the
// rest is too near ½.
struct Stated {
    Scheme scheme;
    std::size_t cells;
    double across, along;
};
constexpr std::array<Stated, 8> kStated{{{Scheme::Bsxw, 3, 5.63, 4.23},
                                         {Scheme::Bsxw, 5, 11.89, 7.15},
                                         {Scheme::Bsxw, 6, 15.15, 7.9},
                                         {Scheme::Bsxw, 7, 18.34, 8.4},
                                         {Scheme::Bsxw, 8, 25.61, 8.75},
                                         {Scheme::CatmullClark, 3, 5.63, 4.22},
                                         {Scheme::CatmullClark, 5, 11.89, 7.15},
                                         {Scheme::CatmullClark, 6, 15.15, 11.22}}};

TEST(EdgeKind, ConstantsAreThoseStated) {
    for (const Stated& stated : kStated) {
        const EdgeKind& kind = edge_kind(stated.scheme, stated.cells);
        const double cosine = std::cos(2 * kPi / static_cast<double>(stated.cells));
        const double rate = (5 + cosine + std::sqrt((1 + cosine) * (9 + cosine))) / 16;  // as of Catmull-Clark surfaces
        EXPECT_NEAR(kind.rate, rate, 1e-12) << name_of(stated.scheme, stated.cells);
        EXPECT_LE(kind.across, stated.across) << name_of(stated.scheme, stated.cells);
        EXPECT_LE(kind.along, stated.along) << name_of(stated.scheme, stated.cells);
        EXPECT_GT(kind.across, stated.across - 0.01) << name_of(stated.scheme, stated.cells);
        EXPECT_GT(kind.along, stated.along - 0.01) << name_of(stated.scheme, stated.cells);
    }
    EXPECT_FALSE(edge_kind(Scheme::CatmullClark, 7).is_bounded());
    EXPECT_FALSE(edge_kind(Scheme::CatmullClark, 8).is_bounded());
    EXPECT_FALSE(edge_kind(Scheme::Bsxw, 9).is_bounded());
}

// No weight may be off by 1e-9.
TEST(EdgeKind, OtherRulesHaveNoConstants) {
    const EdgeRules rules = edge_rules(Scheme::CatmullClark, 5);
    ASSERT_TRUE(make_edge_kind(rules, false).is_bounded());
    EXPECT_FALSE(make_edge_kind(rules, true).is_bounded());  // data along the edge do not stay constant at the edge itself
    std::mt19937 dice(4);
    for (int k = 0; k < 200; ++k) {
        EdgeRules other = rules;
        MatrixXd& rows = k % 4 == 3 ? other.ring[dice() % 2] : other.halves[dice() % 2];
        rows(static_cast<Eigen::Index>(dice()) % rows.rows(), static_cast<Eigen::Index>(dice()) % rows.cols()) += 1e-9;
        EXPECT_FALSE(make_edge_kind(other, false).is_bounded());
    }
}

}  // namespace edge_kind_test
}  // namespace subvol::detail
