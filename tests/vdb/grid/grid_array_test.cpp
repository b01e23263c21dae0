// SPDX-License-Identifier: Apache-2.0
#include "subvol/vdb_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/rasterize.h"
#include "vdb/each_voxel.h"

namespace subvol {
namespace grid_array_test {

using namespace test;

TEST(GridArray, HasTheActiveVoxelsAndNothingElse) {
    const std::vector<std::string> fields{"density"};
    const auto grids = rasterize(make_model("ball", 3), fields, {.voxel_size_world = 0.09});
    const GridArray array = grid_array(grids.front());
    std::size_t active = 0;
    for_each_voxel(grids.front(), [&](const Voxel& v, double value) {
        std::size_t i = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto first = std::lround(array.origin[static_cast<int>(k)] / 0.09);
            i = i * array.size[k] + static_cast<std::size_t>(v[k] - first);
        }
        ASSERT_EQ(static_cast<double>(array.values[i]), value);
        ++active;
    });
    std::size_t numbers = 0;
    for (const float value : array.values) numbers += std::isnan(value) ? 0u : 1u;
    EXPECT_EQ(numbers, active);
    EXPECT_EQ(active, grids.front().report().active_voxels);
    const GridDifference same = compare_voxels(make_grid(array), grids.front());  // throws if an index were another place
    EXPECT_EQ(same.voxels, active);
    EXPECT_EQ(same.max, 0);
}

TEST(GridArray, IsNotMadeOfSizesThatDoNotFit) {
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    EXPECT_THROW((void)make_grid({.size = {2, 1, 1}, .values = {1}}), Error);
    EXPECT_THROW((void)make_grid({.size = {2, 0, 1}, .values = {}}), Error);
    EXPECT_THROW((void)make_grid({.size = {std::size_t{1} << 40, std::size_t{1} << 40, 1}, .values = {1}}), Error);
    EXPECT_THROW((void)make_grid({.size = {1, 1, 1}, .components = 2, .values = {1, 2}}), Error);
    EXPECT_THROW((void)make_grid({.size = {1, 1, 1}, .values = {kInfinite}}), Error);
    EXPECT_THROW((void)make_grid({.size = {1, 1, 1}, .to_world = Mat3(0), .values = {1}}), Error);
    // Each edge is long enough, but OpenVDB would refuse the volume.
    const Mat3 flat({1e-4, 0, 0}, {0, 1e-4, 0}, {1e-4, 0, 1e-9});
    EXPECT_THROW((void)make_grid({.size = {1, 1, 1}, .to_world = flat, .values = {1}}), Error);
}

}  // namespace grid_array_test
}  // namespace subvol
