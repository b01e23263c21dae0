// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "lib/expect_error.h"
#include "openvdb_grids.h"
#include "subvol/rbf_field.h"
#include "subvol/vdb_sample.h"
#include "vdb_data.h"

namespace subvol {
namespace level_set_body_test {

constexpr float kRadius = 1, kVoxel = 0.05F;

VdbGrid sphere(const openvdb::Vec3f& center = {0.5F, 0, 0}) {
    openvdb::initialize();
    return detail::make_vdb_grid(openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(kRadius, center, kVoxel, 3.0F));
}

double volume_of(const Surface& surface) {
    double six = 0;
    for (const auto& t : surface.triangles)
        six += glm::dot(surface.points[t[0]], glm::cross(surface.points[t[1]], surface.points[t[2]]));
    return six / 6;
}

TEST(LevelSetBody, EndsAtTheDistanceZeroSeenFromOutside) {
    const RbfVolume body = sample_rbf_points(sphere()).volume;
    // A point of the surface is the middle of where it meets the edges of a voxel: below a sphere by less than voxel² / radius.
    for (const Vec3& x : body.boundary.points) EXPECT_NEAR(glm::distance(x, Vec3(0.5, 0, 0)), kRadius, kVoxel * kVoxel);
    const double exact = 4 / 3.0 * std::numbers::pi * std::pow(kRadius, 3);
    EXPECT_NEAR(volume_of(body.boundary), exact, 0.005 * exact);  // above 0: outward
    EXPECT_NEAR(body.bounds.size().x, 2 * kRadius, 2 * kVoxel * kVoxel);
}

TEST(LevelSetBody, HasDensityOneInAllOfTheInside) {
    for (const double spacing : {0.0, 0.05, 0.2, 0.7}) {
        const RbfVolume body = sample_rbf_points(sphere(), {.spacing_world = spacing, .kernel = CompactKernel{}}).volume;
        const RbfField field(body);
        for (int n = 0; n < 2000; ++n) {  // a spiral through the ball, to its surface
            const double z = 2 * (n + 0.5) / 2000 - 1, r = kRadius * std::cbrt((n % 40 + 0.5) / 40), turn = 2.4 * n;
            const double flat = std::sqrt(1 - z * z);
            const Vec3 x = Vec3(0.5, 0, 0) + 0.999 * r * Vec3(flat * std::cos(turn), flat * std::sin(turn), z);
            const auto value = field.value(x);
            ASSERT_TRUE(value.has_value()) << spacing << ": " << x.x << " " << x.y << " " << x.z;
            EXPECT_FLOAT_EQ(static_cast<float>(*value), 1);
        }
    }
}

TEST(LevelSetBody, MirroredAxesTurnTheSurface) {
    openvdb::initialize();
    auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(kRadius, openvdb::Vec3f(0.0F), kVoxel, 3.0F);
    openvdb::Mat4d mirror = openvdb::Mat4d::identity();
    mirror.preScale(openvdb::Vec3d(kVoxel, kVoxel, -kVoxel));
    grid->setTransform(openvdb::math::Transform::createLinearTransform(mirror));
    EXPECT_GT(volume_of(sample_rbf_points(detail::make_vdb_grid(grid)).volume.boundary), 4);
}

TEST(LevelSetBody, ThinWallsHaveKernels) {
    openvdb::initialize();
    // A plate of the thickness of half a voxel, between the planes of voxels at 0 and 1.
    auto grid = openvdb::createLevelSet<openvdb::FloatGrid>(0.1, 3.0F);
    auto values = grid->getAccessor();
    for (auto at = openvdb::CoordBBox({-20, -20, -3}, {20, 20, 3}).begin(); at; ++at) {
        const openvdb::Vec3d x = grid->indexToWorld(*at);
        const double side = std::max(std::abs(x[0]), std::abs(x[1])) - 1.5, across = std::abs(x[2]) - 0.025;
        values.setValueOn(*at, static_cast<float>(std::max(side, across)));
    }
    const RbfVolume body = sample_rbf_points(detail::make_vdb_grid(grid), {.spacing_world = 0.4}).volume;
    const RbfField field(body);
    for (double x = -1.45; x < 1.5; x += 0.1) {
        for (const double z : {-0.02, 0.0, 0.02}) EXPECT_TRUE(field.value(Vec3(x, 0.3, z)).has_value()) << x << " " << z;
    }
}

TEST(LevelSetBody, NeedsASurface) {
    openvdb::initialize();
    auto grid = openvdb::createLevelSet<openvdb::FloatGrid>(0.1, 3.0F);
    grid->getAccessor().setValueOn({0, 0, 0}, 0.1F);
    test::expect_error(ErrorCode::InvalidInput, "has the value 0 nowhere",
                       [&] { std::ignore = sample_rbf_points(detail::make_vdb_grid(grid)); });
}

}  // namespace level_set_body_test
}  // namespace subvol
