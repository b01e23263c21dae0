// SPDX-License-Identifier: Apache-2.0
// Samples in the middle of the small cells as well: a body-centred lattice.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/kernels/sample/limit_places.h"
#include "lib/test_meshes.h"
#include "subvol/limit.h"
#include "subvol/model.h"
#include "subvol/rbf_field.h"
#include "subvol/sample.h"

namespace subvol {
namespace sample_centers_test {

constexpr double kFloatTol = 2e-6;  // values and derivatives are 32-bit floats

/// A block of n³ cells of this size, with x² + yz.
HexMesh block_with_squares(Index n, double size) {
    HexMesh mesh = test::make_box(n, n, n);
    for (Vec3& p : mesh.points) p *= size;
    mesh.attributes.clear();
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.x + p.y * p.z; });
    return mesh;
}

double largest(const Vec3& p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

TEST(SampleCenters, AddOneKernelForEachSmallCell) {
    for (const int n : {1, 2, 3}) {
        const HexMesh mesh = test::make_nested_cubes(2);
        const auto without = sample_rbf_points(mesh, {.per_edge = n}).report;
        const auto with = sample_rbf_points(mesh, {.per_edge = n, .centers = true}).report;
        const auto small_cells = mesh.cells.size() * static_cast<std::size_t>(n * n * n);
        EXPECT_EQ(with.points, without.points + small_cells);
        EXPECT_EQ(with.in_cells, without.in_cells + small_cells);
        EXPECT_EQ(with.at_vertices, without.at_vertices);
        EXPECT_EQ(with.flat_frames, 0U);
    }
    // Two intervals along one axis and one along the others: two small cells.
    HexMesh box = block_with_squares(1, 1);
    for (Vec3& p : box.points) p.x *= 2;
    EXPECT_EQ(sample_rbf_points(box, {.spacing_world = 1, .centers = true}).report.in_cells, 2U);
}

TEST(SampleCenters, HaveFramesAndMomentsOfCubesThatHoldOneOfThem) {
    constexpr double kSize = 0.5;
    const HexMesh mesh = block_with_squares(8, kSize);
    const Vec3 center = bounds(mesh).center();
    for (const int n : {1, 2}) {
        const SampleOptions options{.per_edge = n, .centers = true};
        const RbfVolume volume = sample_rbf_points(mesh, options).volume;
        const double radius = support_radius(options.kernel);
        const double edge = kSize / n * std::cbrt(0.5);  // of the cube
        const double diagonal = radius * radius * edge * edge;
        for (std::size_t i = 0; i < volume.size(); ++i) {
            if (largest(volume.centers[i] - center) > kSize) continue;  // the rules at the boundary are others
            const Symmetric3& s = volume.frames[i];
            EXPECT_NEAR(s[0], diagonal, kFloatTol);
            EXPECT_NEAR(s[4], 0, kFloatTol);
            EXPECT_NEAR(volume.channels[0].moments[i], diagonal / 6 * 2, kFloatTol) << "the second derivatives are 2, 0 and 0";
            EXPECT_NEAR(volume.channels[0].gradients[i][0], 2 * volume.centers[i].x, 1e-5);
        }
    }
}

TEST(SampleCenters, WholeHessiansReproduceQuadraticFields) {
    const HexMesh mesh = block_with_squares(8, 0.5);
    const Vec3 center = bounds(mesh).center();
    const RbfVolume volume = sample_rbf_points(mesh, {.centers = true, .correction = Correction::Full}).volume;
    std::vector<Vec3> places;
    for (int i = 0; i < 60; ++i) places.push_back(center + 0.4 * Vec3(std::sin(i), std::sin(2.3 * i), std::cos(1.7 * i)));
    const auto values = RbfField(volume).evaluate(places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Vec3& p = places[i];
        EXPECT_NEAR(values[i], p.x * p.x + p.y * p.z, 2e-5);
    }
}

TEST(SampleCenters, LinearFieldsStayAsTheyAre) {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .03, 4);
    mesh.attributes.clear();
    test::add_field(mesh, "f", [](const Vec3& p) { return 1 + p.x - 2 * p.y + .5 * p.z; });
    const RbfVolume volume = sample_rbf_points(mesh, {.centers = true}).volume;
    const LimitSamples limit = evaluate_limit(mesh, test::places(mesh.cells.size()));
    const auto values = RbfField(volume).evaluate(limit.positions);
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], limit.attributes[0].values[i], 1e-4);
}

/// Second-order errors fall with the square of the spacing: with twice as many samples in a finer grid by 2^(-2/3).
TEST(SampleCenters, HaveLessErrorThanAsManyInAFinerGrid) {
    for (const char* name : {"ball", "twist"}) {
        const HexMesh mesh = make_model(name, 8);
        const LimitSamples limit = evaluate_limit(mesh, test::places(mesh.cells.size()));
        for (const int n : {1, 2}) {
            const double without = test::rmse_at(sample_rbf_points(mesh, {.per_edge = n}).volume, limit);
            const double with = test::rmse_at(sample_rbf_points(mesh, {.per_edge = n, .centers = true}).volume, limit);
            EXPECT_LT(with, without * std::cbrt(0.25)) << name << ' ' << n;
        }
    }
}

}  // namespace sample_centers_test
}  // namespace subvol
