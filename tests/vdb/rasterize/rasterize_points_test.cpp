// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "subvol/error.h"
#include "subvol/rasterize.h"
#include "subvol/rbf_field.h"
#include "subvol/sample.h"
#include "subvol/vdb_grid.h"
#include "vdb/each_voxel.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace rasterize_points_test {

using namespace test;

const std::vector<std::size_t> kFirst{0};
constexpr double kSize = 0.03;

HexMesh box() {
    return with_field(jittered_box_mesh(4), "f", [](const Vec3& p) { return std::sin(5 * p.x) * std::cos(4 * p.y) + p.z; });
}

std::vector<std::pair<Voxel, double>> list(const VdbGrid& grid) {
    std::vector<std::pair<Voxel, double>> all;
    for_each_voxel(grid, [&](const Voxel& v, double value) { all.emplace_back(v, value); });
    return all;
}

// The boundary is a box at every level: it contains the voxels of the mesh, and the sums there have the same bits.
TEST(RasterizePoints, FitsTheSumsAtTheVoxelsOfTheMesh) {
    const HexMesh mesh = box();
    const RbfVolume volume = sample_rbf_points(mesh).volume;
    const RbfField field(volume, {.least_weight = 0});
    const std::vector<std::string> names{"f"};
    const auto of_mesh = rasterize(mesh, names, {.voxel_size_world = kSize, .refine = {.levels = 1}});
    const auto sums = sample_at_voxels(of_mesh.front(), "f", [&](std::span<const Vec3> x) { return field.evaluate(x); });
    const auto grids = rasterize_points(volume, kFirst, {.voxel_size_world = kSize, .mask = true});
    ASSERT_EQ(grids.size(), 2u);
    EXPECT_EQ(grids[0].report().name, "f");
    EXPECT_EQ(grids[1].report().active_voxels, grids[0].report().active_voxels);
    EXPECT_GT(grids[0].report().active_voxels, 30000u);
    EXPECT_TRUE(list(grids[0]) == list(sums));
}

// The surface of a ball: centres within the radius are inside, up to the depth of the chords.
TEST(RasterizePoints, TheBoundaryDecides) {
    const HexMesh mesh = with_field(ball_mesh(8), "f", [](const Vec3& p) { return p.x; });
    const RbfVolume volume = sample_rbf_points(mesh).volume;
    const auto grids = rasterize_points(volume, kFirst, {.voxel_size_world = 0.05, .level_set = LevelSetOptions{}});
    const auto distances = grids.back().voxels();
    const auto cursor = distances->cursor();
    for_each_centre(0.05, 24, [&](const Vec3& p) {
        const double r = glm::length(p);
        const bool active = grids.front().value(p).has_value();
        if (r < 0.98 || r > 1.005) {
            ASSERT_EQ(active, r < 1);
        }
        const Vec3 voxel = glm::round(p / 0.05);
        const VoxelCorners at =
            cursor->corners({static_cast<int>(voxel.x), static_cast<int>(voxel.y), static_cast<int>(voxel.z)});
        ASSERT_EQ(std::signbit(at.values[0]), active);
    });
}

TEST(RasterizePoints, WithoutABoundaryTheWeightsDecide) {
    RbfVolume volume = sample_rbf_points(box()).volume;
    volume.boundary = {};
    const RbfField field(volume);
    const auto grids = rasterize_points(volume, kFirst, {.voxel_size_world = kSize});
    std::size_t active = 0;
    for_each_centre(kSize, 55, [&](const Vec3& p) {
        const auto expected = field.value(p), actual = grids.front().value(p);
        ASSERT_EQ(expected.has_value(), actual.has_value());
        if (!expected) return;
        ++active;
        ASSERT_NEAR(*expected, *actual, 2e-7);  // rounding of a float at 2
    });
    EXPECT_EQ(active, grids.front().report().active_voxels);
    EXPECT_GT(active, 40000u);  // more than the box holds
    EXPECT_THROW((void)rasterize_points(volume, kFirst, {.voxel_size_world = kSize, .level_set = LevelSetOptions{}}), Error);
}

TEST(RasterizePoints, SameForAnyNumberOfThreads) {
    const RbfVolume volume = sample_rbf_points(box()).volume;
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return list(rasterize_points(volume, kFirst, {.resolution = 30}).front());
    };
    EXPECT_TRUE(run(1) == run(2));
}

TEST(RasterizePoints, RefusesWhatCannotBe) {
    const RbfVolume volume = sample_rbf_points(box()).volume;
    EXPECT_THROW((void)rasterize_points(volume, {}, {}), Error);
    const std::vector<std::size_t> missing{3};
    EXPECT_THROW((void)rasterize_points(volume, missing, {}), Error);
    EXPECT_THROW((void)rasterize_points(volume, kFirst, {.voxel_size_world = 1e-4}), Error);
    EXPECT_THROW((void)rasterize_points(volume, kFirst, {.voxel_size_world = -1}), Error);
}

}  // namespace rasterize_points_test
}  // namespace subvol
