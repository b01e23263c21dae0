// SPDX-License-Identifier: Apache-2.0
#include "subvol/sample.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <set>

#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"

namespace subvol {
namespace sample_test {

TEST(Sample, CountsEveryEntityOnce) {
    HexMesh mesh = test::make_nested_cubes(2);
    const auto m = inspect(mesh);
    for (const std::size_t n : {1U, 2U, 3U, 5U}) {
        const auto result = sample_rbf_points(mesh, {.per_edge = static_cast<int>(n)});
        EXPECT_EQ(result.report.points,
                  m.points + m.edges * (n - 1) + m.faces * (n - 1) * (n - 1) + m.cells * (n - 1) * (n - 1) * (n - 1));
        EXPECT_EQ(result.volume.size(), result.report.points);
        std::set<std::array<long, 3>> places;
        for (const auto& c : result.volume.centers)
            places.insert({std::lround(c.x * 1e7), std::lround(c.y * 1e7), std::lround(c.z * 1e7)});
        EXPECT_EQ(places.size(), result.report.points) << "no two samples at one place";
    }
    const auto cell = sample_rbf_points(test::make_box(1, 1, 1), {.per_edge = 4});
    EXPECT_EQ(cell.report.points, 125u);
}

TEST(Sample, ASpacingGivesEachEdgeItsCount) {
    HexMesh mesh = test::make_box(2, 1, 1);
    for (auto& p : mesh.points) p.x *= 3;
    const auto result = sample_rbf_points(mesh, {.spacing_world = 1});
    EXPECT_EQ(result.report.points, 7u * 2 * 2);  // along x in steps of one, along y and z the ends alone
    EXPECT_EQ(result.report.on_edges, 2u * 2 * 4);
}

TEST(Sample, QuadraticFieldsHaveExactDerivativesOnACurvedMesh) {
    // Position and field are quadratic in the parameters: the scheme and the quartics reproduce both, boundary included.
    HexMesh mesh = test::make_box(4, 4, 4);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x + 2 * p.y - p.z + .3 * p.x * p.y; });
    for (auto& p : mesh.points) p = Vec3(p.x + .05 * p.y * p.y, p.y - .04 * p.x * p.z, p.z + .03 * p.x * p.x);
    const auto volume = sample_rbf_points(mesh, {.per_edge = 2}).volume;
    const HexMesh fine = refine(mesh, {.levels = 1});
    const double r2 = support_radius(volume.kernel) * support_radius(volume.kernel);
    for (std::size_t i = 0; i < volume.size(); ++i) {
        // Find the parameters by Newton's method on the known map.
        Vec3 u = volume.centers[i];
        Mat3 jacobian;
        for (int step = 0; step < 20; ++step) {
            jacobian = Mat3(Vec3(1, -.04 * u.z, .06 * u.x), Vec3(.1 * u.y, 1, 0), Vec3(0, -.04 * u.x, 1));
            const Vec3 x(u.x + .05 * u.y * u.y, u.y - .04 * u.x * u.z, u.z + .03 * u.x * u.x);
            u -= glm::inverse(jacobian) * (x - volume.centers[i]);
        }
        const Vec3 g = glm::transpose(glm::inverse(jacobian)) * Vec3(1 + .3 * u.y, 2 + .3 * u.x, -1);
        // L = Σ ∂²f − g·Σ ∂²x per interval of one half; f has no pure second derivatives.
        const double l = -.25 * glm::dot(g, Vec3(.1, 0, .06));
        const auto& channel = volume.channels[0];
        for (int a = 0; a < 3; ++a)
            EXPECT_NEAR(channel.gradients[i][static_cast<std::size_t>(a)], g[a], 1e-5);  // stored as float
        EXPECT_NEAR(channel.moments[i], r2 / 6 * l, 1e-5);
        const Mat3 s = jacobian * glm::transpose(jacobian) * (r2 / 4);
        const auto& f = volume.frames[i];
        const std::array<double, 6> expected{s[0][0], s[1][0], s[2][0], s[1][1], s[2][1], s[2][2]};
        for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(f[k], expected[k], 1e-5);
    }
    EXPECT_EQ(volume.centers.size(), fine.points.size());
}

TEST(Sample, ValuesAreThoseOfTheScheme) {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .02, 3);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(2 * p.x) + p.y * p.z; });
    const HexMesh once = refine(mesh);
    const auto volume = sample_rbf_points(mesh, {.per_edge = 2}).volume;
    ASSERT_EQ(volume.size(), once.points.size());  // the same numbering: vertices, edges, faces, cells (up to the cells' order)
    const std::size_t cells = once.points.size() - mesh.cells.size();
    for (std::size_t p = 0; p < cells; ++p) {
        EXPECT_EQ(volume.centers[p], once.points[p]);
        EXPECT_EQ(volume.channels[0].values[p], static_cast<float>(once.attributes[0].values[p]));
    }
}

TEST(Sample, FlatCellsGetThickFramesAndAreCounted) {
    HexMesh mesh = test::make_box(1, 1, 1);
    for (auto& p : mesh.points) p.z = 0;
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    const auto result = sample_rbf_points(mesh);
    EXPECT_EQ(result.report.flat_frames, 8u);
    for (const auto& f : result.volume.frames) EXPECT_GT(f[5], 0);
}

/// A row of cells, some of them flat; the last ones have shrunk to a point, which is all that kernels at the end see.
HexMesh box_with_degenerate_cells() {
    HexMesh mesh = test::make_box(9, 1, 1);
    for (auto& p : mesh.points) {
        if (p.x == 2) p.z = 0;
        p = p.x >= 3 ? Vec3(0.0) : p - Vec3(3, 0, 0);
    }
    for (auto& p : mesh.points) p += Vec3(.1 * p.y * p.z, .2 * p.x * p.y, .1 * p.x);
    test::add_field(mesh, "f", [](const Vec3& p) { return 1 + p.x - p.y * p.y; });
    return mesh;
}

TEST(Sample, AScaledMeshHasScaledKernels) {
    const HexMesh mesh = box_with_degenerate_cells();
    for (const double scale : {0x1p-20, 0x1p20}) {  // powers of two: products are exact
        HexMesh scaled = mesh;
        for (auto& p : scaled.points) p *= scale;
        for (const SampleOptions& options : {SampleOptions{}, SampleOptions{.per_edge = 2}, SampleOptions{.per_edge = 3}}) {
            const auto one = sample_rbf_points(mesh, options), other = sample_rbf_points(scaled, options);
            EXPECT_GT(one.report.flat_frames, 0u);
            EXPECT_EQ(one.report.flat_frames, other.report.flat_frames);
            const RbfVolume &a = one.volume, &b = other.volume;
            ASSERT_EQ(a.size(), b.size());
            for (std::size_t i = 0; i < a.size(); ++i) {
                ASSERT_EQ(scale * a.centers[i], b.centers[i]);
                for (std::size_t k = 0; k < 6; ++k) {
                    ASSERT_EQ(static_cast<float>(scale * scale * double(a.frames[i][k])), b.frames[i][k]);
                }
                for (std::size_t k = 0; k < 3; ++k) {
                    ASSERT_EQ(double(a.channels[0].gradients[i][k]) / scale, double(b.channels[0].gradients[i][k]));
                }
                ASSERT_EQ(a.channels[0].moments[i], b.channels[0].moments[i]);
            }
        }
    }
}

TEST(Sample, DoesNotDependOnTheNumberOfThreads) {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .02, 3);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(2 * p.x) + p.y * p.z; });
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return sample_rbf_points(mesh, {.per_edge = 3}).volume;
    };
    const auto one = run(1), four = run(4);
    EXPECT_EQ(one.centers, four.centers);
    EXPECT_EQ(one.frames, four.frames);
    EXPECT_EQ(one.channels[0].gradients, four.channels[0].gradients);
    EXPECT_EQ(one.channels[0].moments, four.channels[0].moments);
}

TEST(Sample, RefusesOptionsOutOfRange) {
    const HexMesh mesh = test::make_box(1, 1, 1);
    EXPECT_THROW((void)sample_rbf_points(mesh, {.per_edge = 0}), Error);
    EXPECT_THROW((void)sample_rbf_points(mesh, {.spacing_world = -1}), Error);
    EXPECT_THROW((void)sample_rbf_points(mesh, {.spacing_world = 1e-9}), Error);
    EXPECT_THROW((void)sample_rbf_points(mesh, {.kernel = CompactKernel{.radius = 1}}), Error);
}

}  // namespace sample_test
}  // namespace subvol
