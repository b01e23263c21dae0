// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "lib/temp_folder.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace grid_value_test {

using namespace test;

VdbGrid raster_unit_box(double voxel_size, const test::Field& field) {
    const std::vector<std::string> fields{"f"};
    return std::move(rasterize(with_field(box_mesh(2), "f", field), fields, {.voxel_size_world = voxel_size}).front());
}

TEST(GridValue, LinearBetweenCentres) {
    const auto grid = raster_unit_box(0.1, [](const Vec3& p) { return p.x + 2 * p.y + 4 * p.z; });
    // All eight voxels about these are active; values are floats below 8.
    for (const Vec3 p : {Vec3(0.33, 0.41, 0.77), Vec3(0.05, 0.85, 0.449), Vec3(0.2)}) {
        EXPECT_NEAR(*grid.value(p), p.x + 2 * p.y + 4 * p.z, 1e-6);
    }
}

TEST(GridValue, ConstantUpToTheBorderAndNothingBeyond) {
    const auto grid = raster_unit_box(0.1, [](const Vec3&) { return 3.0; });
    // The lowest voxel is centred at 0 and the highest at 0.9: they reach from -0.05 to 0.95.
    EXPECT_DOUBLE_EQ(*grid.value(Vec3(-0.049)), 3.0);
    EXPECT_DOUBLE_EQ(*grid.value(Vec3(0.949)), 3.0);
    EXPECT_FALSE(grid.value(Vec3(-0.051, 0.5, 0.5)));
    EXPECT_FALSE(grid.value(Vec3(0.5, 0.5, 0.951)));
}

TEST(GridValue, NothingFarAwayOrNowhere) {
    const auto grid = raster_unit_box(0.1, [](const Vec3&) { return 3.0; });
    EXPECT_FALSE(grid.value(Vec3(1e300)));
    EXPECT_FALSE(grid.value(Vec3(-std::numeric_limits<double>::infinity())));
    EXPECT_FALSE(grid.value(Vec3(0.5, std::numeric_limits<double>::quiet_NaN(), 0.5)));
}

using LevelSetFile = TempFolder;

// Inactive voxels of a level set have a side: inside the value is the background below zero, and not nothing.
TEST_F(LevelSetFile, InsideIsTheBackgroundBelowZero) {
    const HexMesh box = with_field(box_mesh(4), "f", [](const Vec3&) { return 1.0; });
    const std::vector<std::string> fields{"f"};
    const double voxel = 0.02, half_width = 3;
    const std::vector<VdbGrid> grids = rasterize(
        box, fields, {.voxel_size_world = voxel, .level_set = LevelSetOptions{.name = "sdf", .half_width_voxels = half_width}});
    write_vdb(path("box.vdb"), grids);
    for (const VdbGrid& grid : read_vdb(path("box.vdb"))) {
        const bool distances = grid.report().name == "sdf";
        EXPECT_NEAR(grid.report().outside, distances ? half_width * voxel : 0, 1e-7);
        EXPECT_NEAR(*grid.value(Vec3(0.5)), distances ? -half_width * voxel : 1, 1e-6);
        EXPECT_NEAR(*grid.value({0.5, 0.5, 0.97}), distances ? -0.03 : 1, 1e-3);
        EXPECT_FALSE(grid.value({0.5, 0.5, 1.5}));
    }
}

}  // namespace grid_value_test
}  // namespace subvol
