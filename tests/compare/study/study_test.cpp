// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "picture_methods.h"
#include "subvol/error.h"
#include "subvol/field_places.h"
#include "subvol/model.h"
#include "subvol/study.h"

namespace subvol {
namespace study_test {

TEST(FieldPlaces, LieWhereTheyWereAskedFor) {
    const HexMesh mesh = make_model("ball", 6);
    constexpr double kWithin = .25;
    const auto boundary = random_places(mesh, "density", PlaceKind::Boundary, kWithin, 500, 1);
    for (const Vec3& x : boundary.points) EXPECT_GT(glm::length(x), 1 - .35 * kWithin);  // shells of a third of the radius
    const auto anywhere = random_places(mesh, "density", PlaceKind::Anywhere, 1, 500, 1);
    double inner = 1;
    for (const Vec3& x : anywhere.points) inner = std::min(inner, glm::length(x));
    EXPECT_LT(inner, .3);
    for (std::size_t i = 0; i < 500; ++i) EXPECT_NEAR(anywhere.values[i], BallField::density(anywhere.points[i]), .02);
    const HexMesh regular = make_model("twist", 3);
    EXPECT_TRUE(random_places(regular, "density", PlaceKind::Extraordinary, 1, 10, 1).points.empty());
}

TEST(BuiltInStudies, AreFilesThatParse) {
    ASSERT_GE(list_studies().size(), 8U);
    for (const StudyInfo& info : list_studies()) {
        const Study study = built_in_study(info.name, picture_methods());
        EXPECT_EQ(study.name, info.name);
        EXPECT_FALSE(study.cases.empty()) << info.name;
        EXPECT_FALSE(study.tables.empty()) << info.name;
    }
    EXPECT_THROW((void)built_in_study("table3", picture_methods()), Error);
}

}  // namespace study_test
}  // namespace subvol
