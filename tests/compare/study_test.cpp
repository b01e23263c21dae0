#include "subvol/study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "subvol/error.h"
#include "subvol/field_error.h"
#include "subvol/model.h"
#include "subvol/sample.h"

namespace subvol {
namespace {

TEST(FieldError, PlacesLieWhereTheyWereAskedFor) {
    const HexMesh mesh = make_model("ball", 6);
    constexpr double kWithin = .25;
    const auto boundary = random_places(mesh, "density", PlaceKind::Boundary, kWithin, 500, 1);
    for (const Vec3& x : boundary.positions) EXPECT_GT(glm::length(x), 1 - .35 * kWithin);  // shells of a third of the radius
    const auto anywhere = random_places(mesh, "density", PlaceKind::Anywhere, 1, 500, 1);
    double inner = 1;
    for (const Vec3& x : anywhere.positions) inner = std::min(inner, glm::length(x));
    EXPECT_LT(inner, .3);
    for (std::size_t i = 0; i < 500; ++i) EXPECT_NEAR(anywhere.values[i], BallField::density(anywhere.positions[i]), .02);
    const HexMesh regular = make_model("twist", 3);
    EXPECT_TRUE(random_places(regular, "density", PlaceKind::Extraordinary, 1, 10, 1).positions.empty());
}

TEST(FieldError, IsTheRootMeanSquareAtThePlaces) {
    HexMesh mesh = make_model("twist", 4);
    for (double& v : mesh.attributes[0].values) v = 2;
    const RbfField field(sample_rbf_points(mesh).volume);
    FieldPlaces places{{Vec3(0.0), Vec3(.01, 0, 0), Vec3(100.0)}, {2.0 - .3, 2.0 + .4, 0}};
    const FieldError error = field_error(field, places);
    EXPECT_NEAR(error.rmse, std::sqrt((.09 + .16) / 2), 1e-6);
    EXPECT_NEAR(error.max, .4, 1e-6);
    EXPECT_EQ(error.missing, 1u);
}

TEST(Study, TablesAreAlignedAndQuoted) {
    const StudyTable table{"t", "Caption", {"name", "½"}, {{"a \"b\"", .5}, {"c", 12.0}, {"d", std::nan("")}}};
    EXPECT_EQ(as_text(table), "Caption\nname     ½\na \"b\"  0.5\nc       12\nd        -\n");
    EXPECT_EQ(as_csv(table), "\"name\",\"½\"\n\"a \"\"b\"\"\",\"0.5\"\n\"c\",\"12\"\n\"d\",\"-\"\n");
}

TEST(Study, UnknownOnesAreRefused) {
    EXPECT_THROW((void)run_study("table3"), Error);
}

}  // namespace
}  // namespace subvol
