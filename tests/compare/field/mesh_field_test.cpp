// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"
#include "subvol/points_field.h"
#include "subvol/rbf_field.h"
#include "subvol/refine.h"
#include "subvol/sample.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace mesh_field_test {

const Vec3 kSlope(1.5, -2, .7);

double linear(const Vec3& x) {
    return .4 + glm::dot(kSlope, x);
}

std::vector<Vec3> random_points(const Box& box, std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Vec3> points(count);
    for (Vec3& p : points) {
        for (int k = 0; k < 3; ++k) p[k] = static_cast<double>(random()) / 4294967296.0;
        p = box.lower + p * box.size();
    }
    return points;
}

/// A linear field is reproduced in every cell; and the cells contain as many random places of the box as their volumes predict.
void expect_linear(const HexMesh& mesh, double tolerance) {
    const MeshField field(mesh, "f");
    const std::size_t count = 20000;
    std::size_t inside = 0;
    for (const Vec3& x : random_points(field.box(), count, 3)) {
        const auto value = field.value(x);
        const auto gradient = field.gradient(x);
        ASSERT_EQ(value.has_value(), gradient.has_value());
        if (!value) continue;
        ++inside;
        ASSERT_NEAR(*value, linear(x), tolerance);
        ASSERT_NEAR(glm::length(*gradient - kSlope), 0, 1e-5);
    }
    const Vec3 size = field.box().size();
    const double share = inspect(mesh).volume / (size.x * size.y * size.z);
    EXPECT_NEAR(static_cast<double>(inside) / count, share, 4 * std::sqrt(std::abs(share * (1 - share)) / count) + 1e-9);
}

TEST(MeshField, LinearFieldsInBoxesAndBalls) {
    expect_linear(test::with_field(test::box_mesh(3), "f", linear), 1e-7);
    expect_linear(test::with_field(test::jittered_box_mesh(5), "f", linear), 1e-7);
    expect_linear(refine(test::with_field(test::ball_mesh(3), "f", linear)), 1e-7);
}

TEST(MeshField, NothingOutside) {
    const MeshField field(test::with_field(test::box_mesh(2), "f", linear), "f");
    EXPECT_TRUE(field.value(Vec3(0.0)));
    EXPECT_TRUE(field.value(Vec3(1.0)));
    EXPECT_FALSE(field.value(Vec3(1.0 + 1e-9, .5, .5)));
    EXPECT_FALSE(field.value(Vec3(NAN)));
    EXPECT_THROW(MeshField(test::box_mesh(2), "f"), Error);
}

TEST(MeshField, GradientIsThatOfTheTrilinearCell) {
    const HexMesh mesh = test::with_field(test::jittered_box_mesh(4), "f", [](const Vec3& x) { return x.x * x.y + x.z * x.z; });
    const MeshField field(mesh, "f");
    constexpr double kStep = 1e-5;
    std::size_t compared = 0;
    for (const Vec3& x : random_points(field.box(), 300, 4)) {
        const auto gradient = field.gradient(x);
        if (!gradient) continue;
        for (int k = 0; k < 3; ++k) {
            Vec3 d(0.0);
            d[k] = kStep;
            const auto before = field.value(x - d), after = field.value(x + d);
            if (!before || !after) continue;
            const double difference = (*after - *before) / (2 * kStep);
            // Across a face the slope jumps by at most the cell's size times the curvature.
            if (std::abs((*gradient)[k] - difference) < 1e-3) ++compared;
        }
    }
    EXPECT_GT(compared, 3 * 300 * 9 / 10);
}

TEST(MeshField, RealMeshes) {
    const char* folder = std::getenv("SUBVOL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "SUBVOL_DATA names no folder of meshes";
    for (const char* name : {"trame_disk_out_ref.vtu", "amanzi_hexes_192.mesh", "sibl_bunny_conforming.mesh"}) {
        SCOPED_TRACE(name);
        const HexMesh mesh = without_unused_points(read_mesh(std::filesystem::path(folder) / name).mesh);
        const double size = bounds(mesh).diagonal();
        expect_linear(test::with_field(mesh, "f", linear), 1e-7 * size);
    }
}

TEST(PointsField, IsThatOfThePointsInsideTheBoundary) {
    const HexMesh mesh = test::with_field(test::ball_mesh(4), "f", linear);
    const RbfVolume volume = sample_rbf_points(mesh, {.boundary_levels = 1}).volume;
    ASSERT_FALSE(volume.boundary.triangles.empty());
    const PointsField field(volume);
    const RbfField everywhere(volume);
    // The boundary's triangles bound the tetrahedra of the level-1 mesh exactly.
    const MeshField solid(refine(mesh), "f");
    std::size_t inside = 0;
    for (const Vec3& x : random_points({1.2 * volume.bounds.lower, 1.2 * volume.bounds.upper}, 20000, 5)) {
        const auto value = field.value(x);
        ASSERT_EQ(value.has_value(), solid.value(x).has_value()) << x.x << ' ' << x.y << ' ' << x.z;
        if (!value) continue;
        ++inside;
        ASSERT_EQ(*value, *everywhere.value(x));
        ASSERT_EQ(*field.gradient(x), everywhere.value_and_gradient(x)->gradient);
    }
    EXPECT_GT(inside, 4000u);
}

TEST(PointsField, RaysThroughEdgesAndCornersCountOnce) {
    RbfVolume volume = sample_rbf_points(test::with_field(test::box_mesh(4), "f", linear), {.boundary_levels = 0}).volume;
    const PointsField field(volume);
    // All rays up the z axis from these places meet corners or edges of the boundary's triangles.
    for (int i = 1; i < 16; ++i) {
        for (int j = 1; j < 16; ++j) {
            const double x = i / 16.0, y = j / 16.0;
            EXPECT_TRUE(field.value(Vec3(x, y, .5)).has_value()) << i << ' ' << j;
            EXPECT_FALSE(field.value(Vec3(x, y, -.01)).has_value()) << i << ' ' << j;
            EXPECT_FALSE(field.value(Vec3(x, y, 1.01)).has_value()) << i << ' ' << j;
        }
    }
}

TEST(PointsField, ACavityIsOutside) {
    RbfVolume volume = sample_rbf_points(test::with_field(test::box_mesh(6), "f", linear), {.boundary_levels = 0}).volume;
    // The box once more, inside out and scaled down about its middle.
    const Surface outer = volume.boundary;
    const auto first = static_cast<Index>(outer.points.size());
    for (const Vec3& p : outer.points) volume.boundary.points.push_back(Vec3(.5) + .4 * (p - Vec3(.5)));
    for (const auto& t : outer.triangles) volume.boundary.triangles.push_back({first + t[0], first + t[2], first + t[1]});
    const PointsField field(volume);
    EXPECT_TRUE(field.value(Vec3(.15, .52, .49)).has_value());
    EXPECT_FALSE(field.value(Vec3(.45, .52, .49)).has_value());
    EXPECT_TRUE(field.value(Vec3(.45, .52, .1)).has_value());
    EXPECT_TRUE(field.value(Vec3(.45, .52, .9)).has_value());
}

TEST(PointsField, WithoutABoundaryWeightsDecide) {
    RbfVolume volume = sample_rbf_points(test::with_field(test::box_mesh(4), "f", linear)).volume;
    volume.boundary = {};
    EXPECT_TRUE(PointsField(volume).value(Vec3(1.05, .5, .5)).has_value());
    EXPECT_THROW(PointsField(volume, 3), Error);
}

}  // namespace mesh_field_test
}  // namespace subvol
