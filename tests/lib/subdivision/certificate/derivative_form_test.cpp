// SPDX-License-Identifier: Apache-2.0
// The constants of the certificate: what is exact is so, and each bound is proved again.
#include "derivative_form.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <random>

#include "cell_parts.h"
#include "lib/test_meshes.h"
#include "subvol/limit.h"

namespace subvol::detail {
namespace derivative_form_test {

std::string name_of(const BoxType& type) {
    std::string name;
    for (const AxisType& axis : type) name += std::to_string(axis.low) + std::to_string(axis.high) + " ";
    return name;
}

// The polynomial takes what the scheme reproduces to its derivatives without an error, so that the rest is 0 there.
TEST(DerivativeForm, ReproducesExactly) {
    const auto types = bounded_types();
    ASSERT_EQ(types.size(), 18u);
    for (const BoxType& type : types) {
        const DerivativeForm& form = derivative_form(type);
        EXPECT_TRUE(is_exact(form)) << name_of(type);
        EXPECT_EQ(form.kept.cols(), type == BoxType{} ? 10 : 4) << name_of(type);
        // Derivatives of linear data: weights have the sum 1.
        EXPECT_LT((form.corners.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12) << name_of(type);
        EXPECT_LT((form.bernstein.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12) << name_of(type);
    }
}

// Steps are dyadic numbers, and keep their sum.
TEST(DerivativeForm, StepsAreExact) {
    for (const BoxType& type : bounded_types()) {
        for (const auto& step : derivative_form(type).steps) {
            const Eigen::MatrixXd scaled = step * 1024;
            EXPECT_EQ(scaled, Eigen::MatrixXd(scaled.array().round())) << name_of(type);
            EXPECT_EQ((step.rowwise().sum().array() - 1).abs().maxCoeff(), 0) << name_of(type);
        }
    }
}

// A bound is proved from those of the children's types, so none may wait for another in a circle.
TEST(DerivativeForm, ChildrenOfTypesAreBoundedBeforeThem) {
    const auto types = bounded_types();
    for (std::size_t k = 0; k < types.size(); ++k) {
        for (std::size_t child = 0; child < 8; ++child) {
            BoxType type = child_type(types[k], child);
            if (type[1] < type[2]) std::swap(type[1], type[2]);
            const auto at = std::ranges::find(types, type);
            EXPECT_LE(at - types.begin(), static_cast<std::ptrdiff_t>(k)) << name_of(types[k]) << child;
        }
    }
}

TEST(DerivativeForm, BoundsAreProvedAgain) {
    const auto types = bounded_types();
    std::vector<std::uint8_t> proved(types.size(), 0);
    tbb::parallel_for(std::size_t{0}, types.size(), [&](std::size_t k) {
        constexpr double kMargin = 1e-3;
        std::size_t parts = 0;
        proved[k] = proves(types[k], *derivative_bound(types[k]) - kMargin, parts);
    });
    for (std::size_t k = 0; k < types.size(); ++k) EXPECT_TRUE(proved[k]) << name_of(types[k]);
    // The rest of the regular cells is .666 somewhere (sampled), so less is not proved.
    std::size_t parts = 0;
    EXPECT_FALSE(proves(BoxType{}, 0.66, parts));
}

// Derivatives at the corners of parts are those of the limit's positions, inside and at a boundary.
TEST(DerivativeForm, CornersAreDerivativesOfTheLimit) {
    HexMesh mesh = test::make_box(7, 7, 7);
    test::jitter(mesh, 0.2, 4);
    constexpr std::size_t kSide = 8;
    for (const std::array<std::size_t, 3>& at : {std::array<std::size_t, 3>{3, 3, 3}, {0, 1, 3}, {6, 3, 5}, {3, 0, 6}}) {
        BoxType type;
        for (std::size_t a = 0; a < 3; ++a) {
            type[a] = {static_cast<std::uint8_t>(std::min<std::size_t>(2, at[a])),
                       static_cast<std::uint8_t>(std::min<std::size_t>(2, 6 - at[a]))};
        }
        ASSERT_TRUE(has_bounds(type));
        std::vector<Vec3> points;
        for (std::size_t i = 0; i < type[0].points(); ++i) {
            for (std::size_t j = 0; j < type[1].points(); ++j) {
                for (std::size_t k = 0; k < type[2].points(); ++k) {
                    points.push_back(mesh.points[(at[0] - type[0].low + i) +
                                                 kSide * ((at[1] - type[1].low + j) + kSide * (at[2] - type[2].low + k))]);
                }
            }
        }
        const auto cell = static_cast<Index>(at[0] + 7 * (at[1] + 7 * at[2]));
        for (const GridPart& part : GridPart(type, points, {}).children()) {
            const PartJacobians found = part.corners();
            for (std::size_t corner = 0; corner < 8; ++corner) {
                const Vec3 place = part.frame().corner(corner);
                constexpr double kStep = 1.0 / 256;
                if (glm::any(glm::lessThan(place, Vec3(kStep))) || glm::any(glm::greaterThan(place, Vec3(1 - kStep)))) continue;
                std::vector<LimitQuery> queries;
                for (int a = 0; a < 3; ++a) {
                    Vec3 step(0.0);
                    step[a] = kStep;
                    queries.push_back({cell, place + step});
                    queries.push_back({cell, place - step});
                }
                const auto x = evaluate_limit(mesh, queries, {.tolerance = 1e-9}).positions;
                const Mat3 j((x[0] - x[1]) / (2 * kStep), (x[2] - x[3]) / (2 * kStep), (x[4] - x[5]) / (2 * kStep));
                // Of a part, which has half the size; a mirror image has the same determinant.
                EXPECT_NEAR(glm::determinant(found.at[corner]) * 8, glm::determinant(j), 5e-3);
            }
        }
    }
}

// Where folds are looked for at the corners of all children, these are the corners that the children have themselves.
TEST(DerivativeForm, CornersOfChildrenAreThoseOfEachChild) {
    std::mt19937 dice(5);
    std::normal_distribution<double> noise(0, 0.3);
    for (const BoxType& type : bounded_types()) {
        std::vector<Vec3> points;
        for (std::size_t i = 0; i < type[0].points(); ++i) {
            for (std::size_t j = 0; j < type[1].points(); ++j) {
                for (std::size_t k = 0; k < type[2].points(); ++k) {
                    points.push_back(Vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)) +
                                     Vec3(noise(dice), noise(dice), noise(dice)));
                }
            }
        }
        const GridPart part(type, points, {});
        const PartJacobians together = part.corners_of_children();
        ASSERT_EQ(together.at.size(), 27u);
        for (const GridPart& child : part.children()) {
            const PartJacobians corners = child.corners();
            for (std::size_t corner = 0; corner < 8; ++corner) {
                const Vec3 place = child.frame().corner(corner);
                std::size_t same = 0;
                for (std::size_t k = 0; k < 27; ++k) {
                    if (part.frame().corner_of_child(k) != place) continue;
                    ++same;  // by the parameters of a child each derivative is half as large
                    EXPECT_NEAR(glm::determinant(together.at[k]), 8 * glm::determinant(corners.at[corner]), 1e-9)
                        << name_of(type);
                }
                EXPECT_EQ(same, 1u);
            }
        }
    }
}

}  // namespace derivative_form_test
}  // namespace subvol::detail
