// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_range.h"

#include <gtest/gtest.h>

#include <limits>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"

namespace subvol {
namespace field_range_test {

TEST(FieldRange, IsThatOfEachChannel) {
    const FieldRange range = range_of({"v", 2, {1, 10, -3, 30, 2, 20}});
    EXPECT_EQ(range.min, (std::vector<double>{-3, 10}));
    EXPECT_EQ(range.max, (std::vector<double>{2, 30}));
    test::expect_error(ErrorCode::InvalidInput, "no values", [] { (void)range_of({"v", 2, {}}); });
}

TEST(FieldRange, ClampsToItsNearerEnd) {
    Attribute field{"v", 2, {1, 5, -9, 35, 2, 20}};
    EXPECT_EQ(clamp_to(field, {{-3, 10}, {2, 30}}), 3u);
    EXPECT_EQ(field.values, (std::vector<double>{1, 10, -3, 30, 2, 20}));
    EXPECT_EQ(clamp_to(field, range_of(field)), 0u);
    test::expect_error(ErrorCode::InvalidInput, "components", [&] { clamp_to(field, {{0}, {1}}); });
}

TEST(FieldRange, ValuesHaveAnOriginWhereFloatsWouldLoseDigits) {
    EXPECT_EQ(value_origin(0, 1), 0);
    EXPECT_EQ(value_origin(15, 16), 0) << "the range is no less than a 16th of the values";
    EXPECT_EQ(value_origin(16, 16.5), 16.25);
    EXPECT_EQ(value_origin(-101325, -101324), -101324.5);
    EXPECT_EQ(value_origin(.1, .1), .1);
    EXPECT_EQ(value_origin(0, 0), 0);
    EXPECT_EQ(value_origin(-1e308, 1e308), 0);
    Attribute field{"p", 1, {101325, 101325.01}};
    EXPECT_NEAR(float_rounding(field), 101325 / .01 / (1 << 25), 1e-3);
    EXPECT_NE(rounding_warning(field).find("p-(101325)"), std::string::npos);
    EXPECT_EQ(rounding_warning({"x", 1, {0, 1}}), "");
    EXPECT_EQ(rounding_warning({"x", 1, {5, 5}}), "") << "a constant has no digits to lose";
    EXPECT_NE(rounding_warning({"x", 1, {100, 101}}, true), "") << "16 bits";
}

TEST(FieldRange, MeshesAreTurnedAndScaled) {
    HexMesh mesh = test::make_box(1, 1, 1);
    mesh.attributes.push_back({"v", 3, {}});
    for (const Vec3& p : mesh.points) mesh.attributes[0].values.insert(mesh.attributes[0].values.end(), {p.x, p.y, p.z});
    const double volume = [&] {
        std::array<Vec3, 8> corners;
        for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[0][k]];
        return cell_volume(corners);
    }();
    const Vec3 up = mesh.points[mesh.cells[0][4]];
    turn_y_up(mesh);
    EXPECT_EQ(up, Vec3(0, 0, 1));
    EXPECT_EQ(mesh.points[mesh.cells[0][4]], Vec3(0, 1, 0)) << "what was up is y";
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const double* v = mesh.attributes[0].values.data() + 3 * p;
        EXPECT_EQ(Vec3(v[0], v[1], v[2]), mesh.points[p]) << "vectors turn with the points";
    }
    scale_points(mesh, 0.5);
    std::array<Vec3, 8> corners;
    for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[0][k]];
    EXPECT_DOUBLE_EQ(cell_volume(corners), volume / 8) << "not mirrored";
    for (const double factor : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
        test::expect_error(ErrorCode::InvalidInput, "positive", [&] { scale_points(mesh, factor); });
}

}  // namespace field_range_test
}  // namespace subvol
