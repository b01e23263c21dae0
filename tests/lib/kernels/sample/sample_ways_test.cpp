// SPDX-License-Identifier: Apache-2.0
// The ways to choose samples: refined meshes and their lines, footprints, tolerances, value rules; and the full correction.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lib/expect_error.h"
#include "lib/kernels/sample/limit_places.h"
#include "lib/test_meshes.h"
#include "subvol/limit.h"
#include "subvol/model.h"
#include "subvol/rbf_field.h"
#include "subvol/sample.h"
#include "subvol/topology.h"

namespace subvol {
namespace sample_ways_test {

/// Smooth on the scale of a cell, so that orders of convergence can be seen.
void put_wave(HexMesh& mesh) {
    mesh.attributes.clear();
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(2 * p.x) * std::cos(1.5 * p.y) + .5 * p.z * p.z; });
}

TEST(SampleWays, RefinedPointsAreTheRefinedMeshAndItsFieldIsTheLimits) {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .02, 3);
    put_wave(mesh);
    for (const int level : {0, 1, 2}) {
        const auto result = sample_rbf_points(mesh, {.per_edge = 1 << level});
        const HexMesh fine = refine(mesh, {.levels = level});
        EXPECT_EQ(result.volume.centers, fine.points);
        EXPECT_EQ(result.report.points,
                  result.report.at_vertices + result.report.on_edges + result.report.on_faces + result.report.in_cells);
    }
}

using Triangle = std::array<std::array<double, 3>, 3>;

std::vector<Triangle> sorted_triangles(const Surface& surface) {
    std::vector<Triangle> all;
    for (const auto& t : surface.triangles) {
        Triangle corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& p = surface.points[t[k]];
            corners[k] = {p.x, p.y, p.z};
        }
        all.push_back(corners);
    }
    std::ranges::sort(all);
    return all;
}

void expect_same_triangles(const Surface& made, const Surface& expected) {
    const auto a = sorted_triangles(made), b = sorted_triangles(expected);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t d = 0; d < 3; ++d) ASSERT_NEAR(a[i][k][d], b[i][k][d], 1e-14);  // rounding: sums in another order
        }
    }
}

TEST(SampleWays, TheBoundaryIsThatOfTheRefinedMesh) {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .02, 3);
    put_wave(mesh);
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear}) {
        const HexMesh start = refine(mesh, {.scheme = {scheme}, .levels = 0});
        for (const int levels : {0, 1, 2, 3}) {
            SCOPED_TRACE(std::to_string(static_cast<int>(scheme)) + ", level " + std::to_string(levels));
            const auto volume = sample_rbf_points(mesh, {.scheme = {scheme}, .boundary_levels = levels}).volume;
            expect_same_triangles(volume.boundary,
                                  boundary_surface(on_limit(refine(start, {.scheme = {scheme}, .levels = levels}), scheme)));
        }
    }
}

TEST(SampleWays, TheBoundaryDoesNotNeedSharpFacesInside) {
    // All points of the sharp face belong to cells at the boundary, but neither of its two cells does.
    HexMesh mesh = test::make_box(3, 3, 4);
    test::jitter(mesh, .1, 5);
    put_wave(mesh);
    const auto id = [](Index i, Index j, Index k) { return i + 4 * (j + 4 * k); };
    mesh.sharp_faces = {{id(1, 1, 2), id(2, 1, 2), id(2, 2, 2), id(1, 2, 2)}};
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        for (const int levels : {1, 2, 3}) {
            const auto volume = sample_rbf_points(mesh, {.scheme = {scheme}, .boundary_levels = levels}).volume;
            expect_same_triangles(volume.boundary,
                                  boundary_surface(on_limit(refine(mesh, {.scheme = {scheme}, .levels = levels}), scheme)));
        }
    }
}

TEST(SampleWays, TheBoundaryOfABoxThatASharpPlaneCuts) {
    // Of the plane's nine faces, the middle one and its creases belong to no cell at the boundary.
    HexMesh mesh = test::make_box(4, 3, 3);
    test::jitter(mesh, .1, 5);
    put_wave(mesh);
    const auto id = [](Index i, Index j, Index k) { return i + 5 * (j + 4 * k); };
    for (Index k = 0; k < 3; ++k) {
        for (Index j = 0; j < 3; ++j) {
            mesh.sharp_faces.push_back({id(2, j, k), id(2, j + 1, k), id(2, j + 1, k + 1), id(2, j, k + 1)});
            mesh.creases.push_back({id(2, j, k), id(2, j, k + 1)});
        }
    }
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        for (const int per_edge : {1, 2, 4}) {
            const auto volume = sample_rbf_points(mesh, {.scheme = {scheme}, .per_edge = per_edge}).volume;
            const int levels = per_edge == 4 ? 3 : per_edge;
            expect_same_triangles(volume.boundary,
                                  boundary_surface(on_limit(refine(mesh, {.scheme = {scheme}, .levels = levels}), scheme)));
        }
    }
}

TEST(SampleWays, TheBoundaryIsAsFineAsHalfASampleInterval) {
    HexMesh mesh = test::make_nested_cubes(2);
    put_wave(mesh);
    const std::size_t quads = boundary_surface(mesh).triangles.size();
    EXPECT_EQ(sample_rbf_points(mesh, {.per_edge = 1}).volume.boundary.triangles.size(), 4 * quads);
    EXPECT_EQ(sample_rbf_points(mesh, {.per_edge = 2}).volume.boundary.triangles.size(), 16 * quads);
    EXPECT_EQ(sample_rbf_points(mesh, {.per_edge = 3}).volume.boundary.triangles.size(), 16 * quads);
    EXPECT_EQ(sample_rbf_points(mesh, {.per_edge = 8}).volume.boundary.triangles.size(), 256 * quads);
    EXPECT_EQ(sample_rbf_points(mesh, {.per_edge = 16}).volume.boundary.triangles.size(), 256 * quads);  // and no finer
}

TEST(SampleWays, LinesAndCellsFindTheGradientOfTheLimit) {
    // Four intervals use the lines of the refined mesh, three the cells. Inside, both are of fourth order in their spacing.
    HexMesh mesh = test::make_box(6, 6, 6);
    for (Vec3& p : mesh.points) p = .2 * Vec3(p.x + .02 * p.y * p.y, p.y - .03 * p.x * p.z, p.z + .02 * p.x * p.y);
    put_wave(mesh);
    for (const int per_edge : {3, 4}) {
        const auto volume = sample_rbf_points(mesh, {.per_edge = per_edge}).volume;
        double worst = 0;
        for (std::size_t i = 0; i < mesh.points.size(); ++i) {
            const Vec3& p = volume.centers[i];
            const Vec3 exact(2 * std::cos(2 * p.x) * std::cos(1.5 * p.y), -1.5 * std::sin(2 * p.x) * std::sin(1.5 * p.y), p.z);
            const auto& g = volume.channels[0].gradients[i];
            const bool inside = i % 7 > 1 && i % 7 < 5 && i / 7 % 7 > 1 && i / 7 % 7 < 5 && i / 49 > 1 && i / 49 < 5;
            if (inside) worst = std::max(worst, glm::distance(Vec3(g[0], g[1], g[2]), exact));
        }
        EXPECT_LT(worst, .01) << per_edge;  // 2·(2h)⁴/30 with cells of h = .2 or less, the scheme's own error
    }
}

TEST(SampleWays, LinesEndAtSharpFaces) {
    // A field with a kink in a sharp plane: one-sided derivatives, whose mean is taken, never across the plane.
    HexMesh mesh = test::make_box(4, 2, 2);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::abs(p.x - 2); });
    const Topology topology = build_topology(mesh);
    for (const auto& face : topology.faces) {
        const bool in_plane = std::all_of(face.begin(), face.end(), [&](Index p) { return mesh.points[p].x == 2; });
        if (in_plane) mesh.sharp_faces.push_back(face);
    }
    const auto volume = sample_rbf_points(mesh).volume;
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const double expected = volume.centers[i].x < 2 ? -1 : volume.centers[i].x > 2 ? 1 : 0;
        EXPECT_NEAR(volume.channels[0].gradients[i][0], expected, 1e-6);
        EXPECT_NEAR(volume.channels[0].moments[i], 0, 1e-6);
    }
}

TEST(SampleWays, FullCorrectionIsOfThirdOrderWhereTheMomentAloneIsOfSecond) {
    HexMesh mesh = test::make_box(12, 12, 12);
    for (Vec3& p : mesh.points) p = .15 * Vec3(p.x + .02 * p.y * p.y, p.y - .01 * p.x * p.z, p.z) - Vec3(1);
    put_wave(mesh);
    std::vector<LimitQuery> inside;  // three cells from the boundary, where steps are one-sided
    for (const LimitQuery& query : test::places(mesh.cells.size())) {
        const Index c = query.cell;
        if (c % 12 > 2 && c % 12 < 9 && c / 12 % 12 > 2 && c / 12 % 12 < 9 && c / 144 > 2 && c / 144 < 9)
            inside.push_back(query);
    }
    const LimitSamples limit = evaluate_limit(mesh, inside, {.tolerance = 1e-8});
    const auto rmse = [&](int per_edge, Correction correction) {
        return test::rmse_at(sample_rbf_points(mesh, {.per_edge = per_edge, .correction = correction}).volume, limit);
    };
    const double second = rmse(1, Correction::Second), second_half = rmse(2, Correction::Second);
    const double full = rmse(1, Correction::Full), full_half = rmse(2, Correction::Full);
    EXPECT_NEAR(std::log2(second / second_half), 2, .4);
    EXPECT_GT(std::log2(full / full_half), 2.7);
    EXPECT_LT(full, second / 2);                     // at this spacing third derivatives contribute to both errors
    const double cells = rmse(3, Correction::Full);  // cell by cell, with another formula for the Hessian
    EXPECT_LT(cells, full / 4);
}

TEST(SampleWays, HessiansOfQuadraticsAreExactInside) {
    HexMesh mesh = test::make_box(5, 5, 5);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x * p.y - 2 * p.y * p.z + p.x * p.x - .5 * p.z * p.z; });
    for (const int per_edge : {1, 3}) {
        const auto volume = sample_rbf_points(mesh, {.per_edge = per_edge, .correction = Correction::Full}).volume;
        const RbfField field(volume);
        for (const Vec3& x : {Vec3(2.3, 2.6, 2.45), Vec3(1.1, 3.9, 2.5), Vec3(2.5, 2.5, 1.75)}) {
            const double exact = x.x * x.y - 2 * x.y * x.z + x.x * x.x - .5 * x.z * x.z;
            EXPECT_NEAR(field.value(x).value(), exact, 2e-5);  // floats of about 10, 20 of them
        }
    }
}

TEST(SampleWays, FootprintsCountEveryEntityOnce) {
    HexMesh mesh = make_model("ball", 4);
    const Footprint footprint{.camera = fit_camera(bounds(mesh), {0, 1, 0}), .width_px = 60, .height_px = 60, .spacing_px = 3};
    const auto result = sample_rbf_points(mesh, {.footprint = footprint});
    const auto& r = result.report;
    EXPECT_EQ(r.points, result.volume.size());
    EXPECT_EQ(r.points, r.at_vertices + r.on_edges + r.on_faces + r.in_cells);
    EXPECT_EQ(r.at_vertices, mesh.points.size());
    EXPECT_GT(r.on_edges, build_topology(mesh).edges.size());  // edges of 6 px and more have at least one sample
    // Neighbours are no farther apart than the spacing: along every edge, as the camera sees it.
    const View view(footprint.camera, footprint.width_px, footprint.height_px);
    const auto half = sample_rbf_points(
        mesh, {.footprint = Footprint{.camera = footprint.camera, .width_px = 120, .height_px = 120, .spacing_px = 3}});
    EXPECT_GT(half.report.points, 4 * r.points);  // half the spacing gives up to eight times the points
    EXPECT_LT(half.report.points, 9 * r.points);
}

TEST(SampleWays, FootprintsLeaveSmallAndUnseenCellsAlone) {
    HexMesh mesh = test::make_box(2, 2, 2);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    Footprint footprint{.camera = {.eye = {1, 1, 50}, .target = {1, 1, 0}}, .width_px = 8, .height_px = 8};
    EXPECT_EQ(sample_rbf_points(mesh, {.footprint = footprint}).report.points, 27u);  // a cell covers a fifth of a pixel
    footprint.width_px = footprint.height_px = 800;
    EXPECT_GT(sample_rbf_points(mesh, {.footprint = footprint}).report.points, 1000u);
    footprint.camera.target = {1, 1, 100};  // it looks away
    EXPECT_EQ(sample_rbf_points(mesh, {.footprint = footprint}).report.points, 27u);
}

TEST(SampleWays, ToleranceIsMetWithFewerSamplesThanEverywhere) {
    HexMesh mesh = test::make_box(10, 10, 10);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::exp(-.8 * glm::dot(p - Vec3(5), p - Vec3(5))); });  // a bump
    constexpr double kTolerance = .004;
    const auto result = sample_rbf_points(mesh, {.tolerance = kTolerance});
    EXPECT_LE(result.report.largest_error, kTolerance);
    const LimitSamples limit = evaluate_limit(mesh, test::places(mesh.cells.size()));
    const auto values = RbfField(result.volume).evaluate(limit.positions);
    for (std::size_t i = 0; i < values.size(); ++i) {
        EXPECT_NEAR(values[i], limit.attributes[0].values[i], 2 * kTolerance);  // it holds at 125 places per cell, not at these
    }
    int most = 1;
    while (true) {
        const auto uniform = sample_rbf_points(mesh, {.per_edge = most});
        double worst = 0;
        const auto at = RbfField(uniform.volume).evaluate(limit.positions);
        for (std::size_t i = 0; i < at.size(); ++i) worst = std::max(worst, std::abs(at[i] - limit.attributes[0].values[i]));
        if (worst <= kTolerance) {
            EXPECT_LT(result.report.points, uniform.report.points / 2);
            break;
        }
        ASSERT_LT(++most, 8);
    }
}

TEST(SampleWays, ToleranceLeavesNoHolesWhereTheFieldIsZero) {
    // A thin strip in long curved cells: kernels at its ends lie along tangents and miss its middle. The field ends early.
    HexMesh mesh = test::make_box(6, 1, 1);
    for (Vec3& p : mesh.points) {
        const double angle = 1.57 * p.x, radius = 1 + .1 * p.y;
        p = Vec3(radius * std::cos(angle), radius * std::sin(angle), .1 * p.z + .3 * angle);
    }
    test::add_field(mesh, "f", [](const Vec3& p) { return p.z < .1 ? 1.0 : 0.0; });
    const HexMesh twice = refine(mesh, {.levels = 2});
    const auto holes = [&](const SampleOptions& options, double value) {
        const auto at = RbfField(sample_rbf_points(mesh, options).volume, {.least_weight = 0}).evaluate(twice.points);
        std::size_t count = 0;
        for (std::size_t p = 0; p < at.size(); ++p) {
            count += std::isnan(at[p]) && std::abs(twice.attributes[0].values[p] - value) < 1e-6 ? 1 : 0;
        }
        return count;
    };
    EXPECT_GT(holes({}, 0), 0u) << "the mesh is a test";
    EXPECT_EQ(holes({.tolerance = .05}, 0), 0u);
    EXPECT_EQ(holes({.tolerance = .05}, 1), 0u);
    EXPECT_LE(sample_rbf_points(mesh, {.tolerance = .05}).report.largest_error, .05);
    // This tolerance is met by kernels with holes: their error is the range of the field or more.
    EXPECT_GE(sample_rbf_points(mesh, {.tolerance = 100}).report.largest_error, 1);
}

TEST(SampleWays, RulesChangeValuesBetweenControlPointsOnly) {
    HexMesh mesh = test::make_box(6, 6, 6);
    put_wave(mesh);
    const auto scheme = sample_rbf_points(mesh, {.per_edge = 2}).volume;
    for (const ValueRule rule : {ValueRule::Cubic, ValueRule::Paper}) {
        const auto points = sample_rbf_points(mesh, {.per_edge = 2, .values = rule}).volume;
        const auto expected = values_at_new_points(mesh, "", rule, SampleOptions{}.value_kernel);
        ASSERT_EQ(points.size(), mesh.points.size() + expected.size());
        const std::size_t cells = points.size() - mesh.cells.size();  // the points of cells are in another order
        for (std::size_t i = 0; i < cells; ++i) {
            const bool control = i < mesh.points.size();
            const double value = control ? mesh.attributes[0].values[i] : expected[i - mesh.points.size()];
            EXPECT_EQ(points.channels[0].values[i], static_cast<float>(value));
            EXPECT_NEAR(glm::distance(points.centers[i], scheme.centers[i]), 0, 1e-14);
        }
    }
}

TEST(SampleWays, DoNotDependOnTheNumberOfThreads) {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .02, 3);
    put_wave(mesh);
    const auto run = [&](std::size_t threads, const SampleOptions& options) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return sample_rbf_points(mesh, options).volume;
    };
    for (const SampleOptions& options :
         {SampleOptions{.per_edge = 4, .correction = Correction::Full}, SampleOptions{.tolerance = .01},
          SampleOptions{.per_edge = 3, .values = ValueRule::Cubic}}) {
        const auto one = run(1, options), four = run(4, options);
        EXPECT_EQ(one.centers, four.centers);
        EXPECT_EQ(one.channels[0].values, four.channels[0].values);
        EXPECT_EQ(one.channels[0].moments, four.channels[0].moments);
        EXPECT_EQ(one.channels[0].hessians, four.channels[0].hessians);
    }
}

TEST(SampleWays, RefuseOptionsOutOfRange) {
    HexMesh mesh = test::make_box(1, 1, 1);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    EXPECT_THROW((void)sample_rbf_points(mesh, {.tolerance = -1}), Error);
    EXPECT_THROW((void)sample_rbf_points(mesh, {.tolerance = std::nan("")}), Error);
    EXPECT_THROW((void)sample_rbf_points(mesh, {.kernel = CubicConvolutionKernel{}}), Error);
    EXPECT_THROW((void)sample_rbf_points(mesh, {.footprint = Footprint{.camera = {}, .spacing_px = 0}}), Error);
    EXPECT_THROW((void)sample_rbf_points(mesh, {.footprint = Footprint{.camera = {}, .width_px = 0}}), Error);
}

}  // namespace sample_ways_test
}  // namespace subvol
