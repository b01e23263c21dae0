// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

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

}  // namespace grid_value_test
}  // namespace subvol
