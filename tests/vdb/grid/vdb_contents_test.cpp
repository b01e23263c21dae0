// SPDX-License-Identifier: Apache-2.0
#include "subvol/vdb_contents.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/rasterize.h"

namespace subvol {
namespace vdb_contents_test {

/// A box with a scalar x and a vector (x, 2y, 3).
HexMesh box_with_fields() {
    HexMesh mesh = test::make_box(2, 1, 1);
    Attribute scalar{"a", 1, {}}, vector{"v", 3, {}};
    for (const Vec3& p : mesh.points) {
        scalar.values.push_back(p.x);
        vector.values.insert(vector.values.end(), {p.x, 2 * p.y, 3});
    }
    mesh.attributes = {scalar, vector};
    return mesh;
}

std::vector<VdbGrid> grids_of_box() {
    const std::vector<std::string> fields{"a", "v"};
    return rasterize(box_with_fields(), fields, {.resolution = 16, .cell_numbers = true, .mask = true});
}

using VdbContentsFile = test::TempFolder;

TEST_F(VdbContentsFile, HasAllGridsInTheirOrder) {
    write_vdb(path("all.vdb"), grids_of_box());
    const VdbContents contents = read_vdb_contents(path("all.vdb"));
    ASSERT_EQ(contents.grids.size(), 4u);
    std::vector<std::string> names, kinds;
    for (const VdbGrid& grid : contents.grids) {
        names.push_back(grid.report().name);
        kinds.push_back(grid.report().kind);
        EXPECT_EQ(grid.report().active_voxels, contents.grids[0].report().active_voxels);
    }
    EXPECT_EQ(names, (std::vector<std::string>{"a", "v", "cell", "mask"}));
    EXPECT_EQ(kinds, (std::vector<std::string>{"float", "vector", "integer", "mask"}));
    EXPECT_TRUE(contents.others.empty());
    test::expect_error(ErrorCode::Io, "none.vdb", [&] { (void)read_vdb_contents(path("none.vdb")); });
}

TEST(VdbContents, VectorsIntegersAndMasksBecomeFloats) {
    const auto grids = grids_of_box();
    const Vec3 place(1.3, 0.4, 0.6);
    const VdbGrid y = scalar_of(grids[1], 1, "v.y"), length = scalar_of(grids[1], std::nullopt, "speed");
    EXPECT_NEAR(y.value(place).value(), 0.8, 1e-5);
    EXPECT_NEAR(length.value(place).value(), std::hypot(1.3, 0.8, 3), 5e-3) << "lengths are interpolated";
    EXPECT_EQ(length.report().name, "speed");
    EXPECT_EQ(length.report().active_voxels, grids[1].report().active_voxels);
    EXPECT_EQ(scalar_of(grids[2], std::nullopt, "c").value(place), 1) << "the second cell";
    EXPECT_EQ(scalar_of(grids[3], std::nullopt, "m").value(place), 1);
    EXPECT_FALSE(scalar_of(grids[3], std::nullopt, "m").value({5, 5, 5}));
    EXPECT_NEAR(scalar_of(grids[0], std::nullopt, "b").value(place).value(), 1.3, 1e-5);
    test::expect_error(ErrorCode::InvalidInput, "component 1", [&] { (void)scalar_of(grids[0], 1, "a.1"); });
    test::expect_error(ErrorCode::InvalidInput, "component 3", [&] { (void)scalar_of(grids[1], 3, "v.3"); });
}

TEST(VdbContents, VoxelsAreClamped) {
    auto grids = grids_of_box();
    clamp_voxels(grids[0], {{0.5}, {1.25}});
    EXPECT_EQ(grids[0].report().min, 0.5);
    EXPECT_EQ(grids[0].report().max, 1.25);
    EXPECT_EQ(grids[0].report().active_voxels, grids[1].report().active_voxels) << "none is lost";
    clamp_voxels(grids[1], {{0, 0, 0}, {1, 1, 1}});
    EXPECT_NEAR(scalar_of(grids[1], 2, "z").report().max, 1, 0);
    EXPECT_NO_THROW(clamp_voxels(grids[3], {{0}, {1}})) << "a mask has no values";
    test::expect_error(ErrorCode::InvalidInput, "components", [&] { clamp_voxels(grids[1], {{0}, {1}}); });
}

TEST(VdbContents, VoxelsNearTheBackgroundAreLeftOut) {
    auto grids = grids_of_box();
    const GridArray before = grid_array(grids[0]);
    constexpr double kTolerance = 0.7;
    std::size_t kept = 0;
    for (const float value : before.values) kept += std::abs(double{value}) > kTolerance ? 1 : 0;  // NaN is not active
    ASSERT_GT(kept, 0u);
    ASSERT_LT(kept, grids[0].report().active_voxels);
    prune_voxels(grids[0], kTolerance);
    EXPECT_EQ(grids[0].report().active_voxels, kept);
    const GridArray after = grid_array(grids[0]);
    for (const float value : after.values) EXPECT_TRUE(std::isnan(value) || std::abs(double{value}) > kTolerance);
    // Of vectors the length counts; a mask has no values.
    const std::size_t vectors = grids[1].report().active_voxels;
    const double longest = scalar_of(grids[1], std::nullopt, "length").report().max;
    prune_voxels(grids[1], .999 * longest);
    EXPECT_LT(grids[1].report().active_voxels, vectors);
    EXPECT_GT(scalar_of(grids[1], std::nullopt, "length").report().min, .999 * longest);
    const std::size_t mask = grids[3].report().active_voxels;
    prune_voxels(grids[3], 9);
    EXPECT_EQ(grids[3].report().active_voxels, mask);
}

}  // namespace vdb_contents_test
}  // namespace subvol
