// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_slice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/model.h"

namespace subvol {
namespace limit_slice_test {

TEST(Slice, OfTheBallIsADisk) {
    const LimitSlice slice = slice_limit(make_model("ball", 6), {}, {0, 0, 0.2}, {0, 0, 1}, {.resolution = 100});
    const double step = glm::length(slice.right);
    const double area = static_cast<double>(slice.inside) * step * step;
    EXPECT_NEAR(area, std::numbers::pi * (1 - 0.04), 0.05);  // the rim's squares: 2π of a step each way
    for (std::size_t p = 0; p < slice.values.size(); ++p) {
        const auto width = static_cast<std::size_t>(slice.width);
        const Vec3 x = slice.place(static_cast<double>(p % width), static_cast<double>(p / width));
        EXPECT_NEAR(x.z, 0.2, 1e-12);
        EXPECT_EQ(std::isnan(slice.values[p]), slice.cells[p] == kNone);
        if (std::abs(glm::length(x) - 1) > 0.01) {
            EXPECT_EQ(glm::length(x) < 1, slice.cells[p] != kNone);
        }
    }
}

TEST(Slice, IsSeenFromWhereItsNormalPoints) {
    HexMesh mesh = test::make_box(3, 2, 1);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.y; });
    const LimitSlice slice = slice_limit(mesh, "f", {1.5, 1, 0.5}, {1, 0, 0}, {.resolution = 20});
    EXPECT_GT(slice.right.y, 0);  // from +x, with z up, y goes to the right
    EXPECT_LT(slice.down.z, 0);
    EXPECT_LT(glm::dot(glm::cross(slice.right, slice.down), Vec3(1, 0, 0)), 0);
    EXPECT_GT(slice.width, slice.height);
    const auto middle = static_cast<std::size_t>(slice.height / 2 * slice.width);
    EXPECT_LT(slice.values[middle + 3], slice.values[middle + 15]);
}

TEST(Slice, ContoursAreWhereTheFieldHasTheirValue) {
    HexMesh mesh = test::make_box(4, 4, 2);
    test::add_field(mesh, "f", [](const Vec3& p) { return glm::dot(p - Vec3(2, 2, 1), p - Vec3(2, 2, 1)); });
    const LimitSlice slice = slice_limit(mesh, "f", {2, 2, 1}, {0, 0, 1}, {.resolution = 128});
    const auto lines = contour_lines(slice, std::vector<double>{1.0, 6.5});
    std::size_t closed = 0;
    for (const ContourLine& line : lines) {
        const double radius = std::sqrt(line.value);
        for (const Vec2& at : line.places) {
            // Linear between places: second order in their distance of 1/32.
            EXPECT_NEAR(glm::distance(slice.place(at.x, at.y), Vec3(2, 2, 1)), radius, 1e-3);
        }
        if (line.value == 1.0) closed += line.places.front() == line.places.back() ? 1 : 0;
    }
    EXPECT_EQ(closed, 1u);
    EXPECT_EQ(lines.size(), 5u) << "one circle, and one arc in each corner";
}

class SliceFiles : public test::TempFolder {};

TEST_F(SliceFiles, TablesHaveARowForEachPlaceInside) {
    const LimitSlice slice = slice_limit(make_model("ball", 4), {}, {0, 0, 0}, {0, 1, 0}, {.resolution = 16});
    write_slice(path("a.csv"), slice);
    write_slice(path("a.vtp"), slice, contour_lines(slice, std::vector<double>{0.0}));
    std::ifstream in(path("a.csv"));
    std::size_t rows = 0;
    for (std::string line; std::getline(in, line);) ++rows;
    EXPECT_EQ(rows, slice.inside + 1);
    test::expect_error(ErrorCode::InvalidInput, ".vtp", [&] { write_slice(path("a.txt"), slice); });
}

TEST(Slice, RefusesPlanesThatMissAndOptionsOutOfRange) {
    const HexMesh mesh = make_model("ball", 4);
    const auto refused = [&](const std::string& what, const Vec3& point, const Vec3& normal, int resolution) {
        test::expect_error(ErrorCode::InvalidInput, what,
                           [&] { (void)slice_limit(mesh, {}, point, normal, {.resolution = resolution}); });
    };
    refused("misses", {0, 0, 3}, {0, 0, 1}, 10);
    refused("direction", {0, 0, 0}, {0, 0, 0}, 10);
    refused("resolution", {0, 0, 0}, {0, 0, 1}, 1);
}

}  // namespace limit_slice_test
}  // namespace subvol
