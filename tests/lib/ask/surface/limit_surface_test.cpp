// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_surface.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/detail/boundary_level.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/triangle_distance.h"
#include "subvol/model.h"

namespace subvol {
namespace limit_surface_test {

/// The ball with the squared distance from its centre: isosurfaces are spheres as far as the limit has the field.
HexMesh ball_with_radius(int resolution) {
    HexMesh mesh = make_model("ball", resolution);
    mesh.attributes.clear();
    test::add_field(mesh, "r2", [](const Vec3& p) { return glm::dot(p, p); });
    return mesh;
}

/// The distance of the triangles' centres from the isosurface of the limit, by its value and gradient there.
struct Distance {
    double rms = 0, largest = 0;
};
Distance distance_to_limit(const HexMesh& mesh, const Surface& surface, double iso) {
    std::vector<Vec3> centers;
    for (const auto& t : surface.triangles)
        centers.push_back((surface.points[t[0]] + surface.points[t[1]] + surface.points[t[2]]) / 3.0);
    const ProbeResult found = LimitProbe(mesh).at(centers);
    Distance distance;
    for (std::size_t p = 0; p < centers.size(); ++p) {
        EXPECT_TRUE(found.inside(p));
        const double one = std::abs(found.fields[0].values[p] - iso) / glm::length(found.fields[0].gradients[p]);
        distance.largest = std::max(distance.largest, one);
        distance.rms += one * one / static_cast<double>(centers.size());
    }
    distance.rms = std::sqrt(distance.rms);
    return distance;
}

TEST(LimitSurface, PointsLieOnTheLimitAndHaveItsGradient) {
    const HexMesh mesh = make_model("ball", 4);
    const LimitSurface found = limit_surface(mesh, "density", {.isos = {0.2}});
    ASSERT_GT(found.surface.triangles.size(), 100u);
    const LimitSamples samples = evaluate_limit(mesh, found.places, {.tolerance = 1e-8, .max_levels = 14});
    for (std::size_t p = 0; p < found.places.size(); ++p) {
        // The tolerance of the limit (1e-6 of the diagonal and of the range), and of the last step.
        ASSERT_NEAR(samples.attributes[0].values[p], 0.2, 5e-5) << p;
        ASSERT_NEAR(glm::distance(samples.positions[p], found.surface.points[p]), 0, 3e-5) << p;
        const Vec3& gradient = found.fields[0].gradients[p];
        EXPECT_GT(glm::dot(found.normals[p], -gradient / glm::length(gradient)), 0.999) << p;
    }
}

// A mesh's only field is found with the points, those of several in a second evaluation: both are the limit's at the places.
TEST(LimitSurface, FieldsAreThoseOfTheLimitWhetherThereAreOneOrSeveral) {
    HexMesh mesh = ball_with_radius(4);
    HexMesh more = mesh;
    test::add_field(more, "g", [](const Vec3& p) { return p.x - p.y * p.z; });
    for (const SurfaceOptions& options : {SurfaceOptions{.boundary = true}, SurfaceOptions{.isos = {0.3}}}) {
        const LimitSurface one = limit_surface(mesh, "r2", options), several = limit_surface(more, "r2", options);
        ASSERT_EQ(one.fields.size(), 1u);
        ASSERT_EQ(several.fields.size(), 2u);
        const LimitSamples samples = evaluate_limit(more, several.places, {.tolerance = 1e-8, .max_levels = 14});
        ASSERT_EQ(one.surface.triangles, several.surface.triangles);
        for (std::size_t p = 0; p < several.places.size(); ++p) {
            // The tolerance of the limit: 1e-6 of the diagonal and of the range, and what a step of 1e-3 of a cell leaves.
            ASSERT_NEAR(glm::distance(several.surface.points[p], samples.positions[p]), 0, 3e-5) << p;
            ASSERT_NEAR(one.fields[0].values[p], samples.attributes[0].values[p], 3e-5) << p;
            ASSERT_NEAR(several.fields[1].values[p], samples.attributes[1].values[p], 3e-5) << p;
        }
    }
}

TEST(LimitSurface, SphereIsClosedAndRightToSecondOrder) {
    // Triangles with corners on a sphere are nearer to it by the square of their edges: four times for each level.
    const HexMesh mesh = ball_with_radius(4);
    Distance last;
    for (const int level : {1, 2, 3}) {
        const LimitSurface found =
            limit_surface(mesh, "r2", {.isos = {0.25}, .tolerance = 1e-9, .max_level = level, .improve = false});
        EXPECT_EQ(found.report.level, level);
        EXPECT_FALSE(found.report.converged);
        EXPECT_TRUE(found.report.watertight);
        EXPECT_EQ(found.report.euler, 2);
        EXPECT_EQ(found.report.components, 1u);
        EXPECT_LT(found.report.volume, 0) << "the field is at least the value outside the sphere: normals point inwards";
        const Distance distance = distance_to_limit(mesh, found.surface, 0.25);
        EXPECT_LT(distance.largest, 3 * found.report.deviation_world) << "the estimate is of the right size";
        if (level > 1) {
            EXPECT_GT(std::log2(last.rms / distance.rms), 1.8);
            EXPECT_GT(std::log2(last.largest / distance.largest), 1.4) << "the limit has no curvature at irregular edges";
        }
        last = distance;
    }
}

TEST(LimitSurface, SpheresOfAFineMeshAreThoseOfTheClosedForm) {
    const LimitSurface found = limit_surface(ball_with_radius(12), "r2", {.isos = {0.25}, .tolerance = 1e-4});
    EXPECT_TRUE(found.report.converged);
    EXPECT_NEAR(found.report.area / std::numbers::pi, 1, 2e-3);
    EXPECT_NEAR(-found.report.volume / (std::numbers::pi / 6), 1, 2e-3);
}

TEST(LimitSurface, BoundaryOfTheBallHasItsAreaAndVolume) {
    const LimitSurface found = limit_surface(make_model("ball", 10), {}, {.boundary = true, .tolerance = 2e-5, .max_level = 3});
    EXPECT_TRUE(found.report.watertight);
    EXPECT_EQ(found.report.euler, 2);
    // Level 3 has triangles of 1/40: their chords take 2e-4 of the volume.
    EXPECT_NEAR(found.report.volume / (4.0 / 3 * std::numbers::pi), 1, 3e-4);
    EXPECT_NEAR(found.report.area / (4 * std::numbers::pi), 1, 3e-4);
    double worst = 1;
    for (std::size_t p = 0; p < found.normals.size(); ++p)
        worst = std::min(worst, glm::dot(found.normals[p], glm::normalize(found.surface.points[p])));
    EXPECT_GT(worst, std::cos(3 * std::numbers::pi / 180)) << "normals are those of the sphere to three degrees";
}

TEST(LimitSurface, BoundaryOfTheNozzleIsThatOfABody) {
    const LimitSurface found = limit_surface(make_model("nozzle", 16), {}, {.boundary = true});
    EXPECT_TRUE(found.report.watertight);
    EXPECT_GT(found.report.volume, 0);
    EXPECT_EQ(found.report.euler % 2, 0);
}

TEST(LimitSurface, BoundaryOfARingHasEulerCharacteristicZero) {
    HexMesh mesh = test::make_box(3, 3, 1);
    mesh.cells.erase(mesh.cells.begin() + 4);  // the middle
    mesh = without_unused_points(std::move(mesh));
    const LimitSurface found = limit_surface(mesh, {}, {.boundary = true});
    EXPECT_TRUE(found.report.watertight);
    EXPECT_EQ(found.report.euler, 0);
    EXPECT_NEAR(found.report.volume, 8, 0.5);  // the reentrant edges are smooth
}

TEST(LimitSurface, ACapClosesAnIsosurfaceThatLeavesTheVolume) {
    HexMesh mesh = test::make_box(4, 4, 4);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x + 0.3 * p.y; });
    const LimitSurface open = limit_surface(mesh, "f", {.isos = {2.1}});
    EXPECT_FALSE(open.report.watertight);
    EXPECT_EQ(open.report.euler, 1);  // a disk
    const LimitSurface closed = limit_surface(mesh, "f", {.isos = {2.1}, .cap = true});
    EXPECT_TRUE(closed.report.watertight);
    EXPECT_EQ(closed.report.euler, 2);
    // The part with x ≥ 2.1 − .3 y.
    EXPECT_NEAR(closed.report.volume, 4 * (4 * (4 - 2.1) + 0.3 * 16 / 2), 1e-6);
    EXPECT_NEAR(open.report.area, 4 * std::hypot(4, 1.2), 1e-6);
}

TEST(LimitSurface, ValuesAtVerticesDoNotBreakIt) {
    // The isovalue is that of a whole layer of control points.
    HexMesh mesh = test::make_box(4, 4, 4);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    const LimitSurface closed = limit_surface(mesh, "f", {.isos = {2}, .cap = true});
    EXPECT_TRUE(closed.report.watertight);
    EXPECT_NEAR(closed.report.volume, 32, 1e-9);
}

TEST(LimitSurface, IsClosedAndManifoldOnIrregularMeshes) {
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Linear}) {
        HexMesh mesh = test::irregular();
        test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(5 * p.x) * std::cos(4 * p.y) + p.z; });
        const LimitSurface found =
            limit_surface(mesh, "f", {.scheme = {.kind = scheme}, .isos = {0.1, 0.4}, .cap = true, .max_level = 3});
        EXPECT_TRUE(found.report.watertight);
        EXPECT_GT(found.report.volume, 0);
    }
}

// Where a cap meets its isosurface, points of both lie close together.
TEST(LimitSurface, CapsHaveHardlyASliver) {
    const HexMesh mesh = make_model("twist", 10);
    const SurfaceOptions options{.isos = {0.1}, .cap = true};
    SurfaceOptions as_cut = options;
    as_cut.improve = false;
    const SurfaceReport before = limit_surface(mesh, "density", as_cut).report,
                        after = limit_surface(mesh, "density", options).report;
    EXPECT_GT(before.small_angles, 0.1);
    EXPECT_LT(after.small_angles, 0.002);
    EXPECT_GT(after.mended, 0U);
    EXPECT_TRUE(after.watertight);
    EXPECT_EQ(after.euler, before.euler);
    EXPECT_NEAR(after.area / before.area, 1, 2e-3);
}

TEST(LimitSurface, CollapsingLeavesFewerSlivers) {
    const HexMesh mesh = ball_with_radius(6);
    const LimitSurface before = limit_surface(mesh, "r2", {.isos = {0.3}, .improve = false});
    const LimitSurface after = limit_surface(mesh, "r2", {.isos = {0.3}});
    EXPECT_TRUE(before.report.watertight);
    EXPECT_TRUE(after.report.watertight);
    EXPECT_EQ(before.report.euler, after.report.euler);
    EXPECT_GT(after.report.min_angle_deg, before.report.min_angle_deg);
    EXPECT_LT(after.surface.triangles.size(), before.surface.triangles.size());
    EXPECT_NEAR(after.report.volume / before.report.volume, 1, 5e-3);
}

// The boundary alone.

/// Cells of a box whose middles are within a radius of its centre: stairs in all directions.
HexMesh stairs(Index n, double radius) {
    HexMesh mesh = test::make_box(n, n, n);
    const Vec3 center(0.5 * n);
    std::erase_if(mesh.cells, [&](const auto& cell) {
        return glm::distance(0.5 * (mesh.points[cell[0]] + mesh.points[cell[6]]), center) > radius;
    });
    return without_unused_points(std::move(mesh));
}

/// A block with a footing in the middle of its top.
HexMesh block_with_footing(Index n) {
    HexMesh mesh = test::make_box(n, n, n);
    std::erase_if(mesh.cells, [&](const auto& cell) {
        const Vec3 middle = 0.5 * (mesh.points[cell[0]] + mesh.points[cell[6]]);
        const auto outside = [&](double t) { return t < n / 3 || t > n - n / 3; };
        return middle.z > n - 2 && (outside(middle.x) || outside(middle.y));
    });
    return without_unused_points(std::move(mesh));
}

double distance_to(const Vec3& p, const Surface& surface) {
    double least = HUGE_VAL;
    for (const auto& t : surface.triangles) {
        const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
        const double far = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
        if (glm::distance(p, a) > far + least) continue;
        const Vec3 weights = detail::nearest_in_triangle(p, a, b, c).weights;
        least = std::min(least, glm::distance(p, weights.x * a + weights.y * b + weights.z * c));
    }
    return least;
}

/// How far some places of a surface are from another one, at most.
double farthest(const Surface& surface, const Surface& other, std::size_t places) {
    const std::size_t stride = 1 + surface.triangles.size() / places;
    double most = 0;
    for (std::size_t i = 0; i < surface.triangles.size(); i += stride) {
        const auto& [a, b, c] = surface.triangles[i];
        for (const Vec3& w : {Vec3(1, 1, 1) / 3.0, Vec3(0.5, 0.5, 0), Vec3(0.25, 0, 0.75), Vec3(0, 0.8, 0.2)})
            most =
                std::max(most, distance_to(w.x * surface.points[a] + w.y * surface.points[b] + w.z * surface.points[c], other));
    }
    return most;
}

void expect_closed(const LimitSurface& found) {
    std::map<std::array<Index, 2>, int> directed;
    for (const auto& t : found.surface.triangles) {
        EXPECT_TRUE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
        for (std::size_t k = 0; k < 3; ++k) ++directed[{t[k], t[(k + 1) % 3]}];
    }
    for (const auto& [edge, count] : directed) {
        const auto back = directed.find({edge[1], edge[0]});
        ASSERT_TRUE(back != directed.end() && back->second == count);
    }
}

TEST(LimitSurface, AFlatFaceIsTwoTriangles) {
    HexMesh mesh = test::make_box(5, 4, 3);
    for (Vec3& p : mesh.points) p = {p.x + 0.3 * p.y, p.y - 0.2 * p.z, 0.7 * p.z + 0.1 * p.x};
    const LimitSurface found = limit_surface(mesh, {}, {.scheme = {.crease_angle_deg = 40}, .boundary = true});
    EXPECT_EQ(found.surface.triangles.size(), 2U * 2 * (5 * 4 + 4 * 3 + 5 * 3));
    EXPECT_EQ(found.report.level, 0);
    EXPECT_EQ(found.report.deviation_world, 0);
    EXPECT_TRUE(found.report.converged);
    EXPECT_TRUE(found.report.watertight);
    const Mat3 map{{1, 0, 0.1}, {0.3, 1, 0}, {0, -0.2, 0.7}};
    EXPECT_NEAR(found.report.volume, 60 * glm::determinant(map), 1e-9);
    for (const Vec3& normal : found.normals) EXPECT_NEAR(glm::length(normal), 1, 1e-12);
}

TEST(LimitSurface, StairsWithCreasesAreExact) {
    const HexMesh mesh = stairs(7, 3.4);
    const LimitSurface found = limit_surface(mesh, {}, {.scheme = {.crease_angle_deg = 40}, .boundary = true});
    const Surface faces = boundary_surface(mesh);
    EXPECT_EQ(found.surface.triangles.size(), faces.triangles.size());
    EXPECT_NEAR(found.report.area, 0.5 * static_cast<double>(faces.triangles.size()), 1e-9);
    EXPECT_NEAR(found.report.volume, static_cast<double>(mesh.cells.size()), 1e-9);
    EXPECT_TRUE(found.report.watertight);
}

// The reference is the refinement of the cells at the boundary, all to one level.
TEST(LimitSurface, TheBoundaryIsWithinItsToleranceOfTheLimit) {
    HexMesh bent = test::irregular();
    test::jitter(bent, .05, 3);
    for (const HexMesh& mesh : {stairs(4, 2.2), stairs(5, 2.4), bent, make_model("ball", 3)}) {
        const Surface reference = detail::boundary_at_level(mesh, {.levels = 4});
        const Vec3 size = detail::limit_extent(mesh).box.size();
        const double longest = std::max({size.x, size.y, size.z});
        for (const double tolerance : {1e-2, 2e-3}) {
            const LimitSurface found = limit_surface(mesh, {}, {.boundary = true, .tolerance = tolerance, .max_level = 8});
            EXPECT_TRUE(found.report.converged);
            EXPECT_LE(found.report.deviation_world, tolerance * longest);
            expect_closed(found);
            // A sixth of the tolerance is left for the chords of the reference.
            EXPECT_LE(farthest(found.surface, reference, 300), 7.0 / 6 * tolerance * longest);
            EXPECT_LE(farthest(reference, found.surface, 300), 7.0 / 6 * tolerance * longest);
        }
    }
}

TEST(LimitSurface, PointsOfTheBoundaryLieOnTheLimit) {
    HexMesh castle = stairs(5, 2.4), blocks = test::make_box(3, 2, 2);
    test::jitter(castle, .1, 5);
    test::jitter(blocks, .1, 6);
    // A sharp face between cells, which meets the boundary.
    blocks.sharp_faces.push_back({blocks.cells[0][1], blocks.cells[0][2], blocks.cells[0][6], blocks.cells[0][5]});
    for (const HexMesh& mesh : {castle, blocks, test::irregular()}) {
        for (const Scheme scheme : {Scheme::Mcq, Scheme::Linear}) {
            const LimitSurface found = limit_surface(mesh, {}, {.scheme = {.kind = scheme}, .boundary = true});
            const LimitSamples samples = evaluate_limit(mesh, found.places, {.scheme = {.kind = scheme}, .tolerance = 1e-8});
            for (std::size_t p = 0; p < found.places.size(); ++p)
                ASSERT_NEAR(glm::distance(samples.positions[p], found.surface.points[p]), 0, 1e-6) << p;
            expect_closed(found);
        }
    }
}

TEST(LimitSurface, OnlyWhatBendsIsRefined) {
    const HexMesh mesh = block_with_footing(12);
    const LimitSurface found = limit_surface(mesh, {}, {.boundary = true});
    EXPECT_GE(found.report.level, 1);
    const std::size_t of_one_level = boundary_surface(mesh).triangles.size() << (2 * found.report.level);
    EXPECT_LT(found.surface.triangles.size(), of_one_level / 8);
    EXPECT_TRUE(found.report.watertight);
    EXPECT_TRUE(found.report.converged);
    // The points of a coarser tolerance are fewer, its surface the same to it.
    const LimitSurface coarse = limit_surface(mesh, {}, {.boundary = true, .tolerance = 1e-2});
    EXPECT_LE(coarse.surface.triangles.size(), found.surface.triangles.size());
    EXPECT_NEAR(coarse.report.volume / found.report.volume, 1, 1e-2);
}

TEST(LimitSurface, CellsThatTouchHaveAClosedBoundary) {
    HexMesh mesh = test::make_box(2, 2, 2);
    mesh.cells = {mesh.cells[0], mesh.cells[3], mesh.cells[6]};  // they have edges in common
    test::jitter(mesh, .1, 2);
    mesh = without_unused_points(std::move(mesh));
    const LimitSurface found = limit_surface(mesh, {}, {.boundary = true, .tolerance = 1e-3});
    expect_closed(found);
    EXPECT_GT(found.report.volume, 2);
}

TEST(LimitSurface, AFinestLevelEndsTheRefinement) {
    const HexMesh mesh = stairs(5, 2.4);
    const LimitSurface found = limit_surface(mesh, {}, {.boundary = true, .tolerance = 1e-6, .max_level = 2});
    EXPECT_EQ(found.report.level, 2);
    EXPECT_FALSE(found.report.converged);
    expect_closed(found);
    const LimitSurface few = limit_surface(mesh, {}, {.boundary = true, .tolerance = 1e-6, .max_triangles = 4000});
    EXPECT_FALSE(few.report.converged);
    EXPECT_LE(few.surface.triangles.size(), 4000U);
    expect_closed(few);
}

TEST(LimitSurface, HasNoFieldsUnlessTheyAreWanted) {
    const HexMesh mesh = ball_with_radius(3);
    for (SurfaceOptions options : {SurfaceOptions{.boundary = true}, SurfaceOptions{.isos = {0.3}, .boundary = true}}) {
        const LimitSurface with = limit_surface(mesh, "r2", options);
        options.fields = false;
        const LimitSurface without = limit_surface(mesh, "r2", options);
        EXPECT_EQ(with.fields.size(), 1U);
        EXPECT_TRUE(without.fields.empty());
        EXPECT_EQ(with.surface.points, without.surface.points);  // the bend of the ball asks for more than that of the field
        EXPECT_EQ(with.surface.triangles, without.surface.triangles);
        EXPECT_EQ(with.normals, without.normals);
    }
}

// A beam whose flat faces are two triangles but where the field bends: along x it is that of the points, 0 to 10.
HexMesh beam_with(const std::function<double(const Vec3&)>& field) {
    HexMesh mesh = test::make_box(8, 3, 2);
    Attribute values{"T", 1, {}};
    for (const Vec3& x : mesh.points) values.values.push_back(field(x));
    mesh.attributes = {values};
    return mesh;
}

TEST(LimitSurface, ALinearFieldLeavesFlatFacesAsTheyAre) {
    const SurfaceOptions options{.scheme = {.crease_angle_deg = 40}, .boundary = true};
    for (const auto& field : {+[](const Vec3& x) { return 3 * x.x - x.y + 0.5 * x.z; }, +[](const Vec3&) { return 7.0; }}) {
        const LimitSurface found = limit_surface(beam_with(field), {}, options);
        EXPECT_EQ(found.surface.triangles.size(), 2U * 2 * (8 * 3 + 3 * 2 + 8 * 2));
    }
}

// The second evaluator is that of places in cells: at the centres of triangles it is compared with the means of their corners.
TEST(LimitSurface, FlatFacesAreDividedWhereAFieldBends) {
    const HexMesh mesh = beam_with([](const Vec3& x) { return x.x == 4 || x.x == 5 ? 10.0 : 0; });
    const auto error_of_fields = [&](const LimitSurface& found) {
        std::vector<LimitQuery> centres;
        std::vector<double> means;
        for (const auto& [a, b, c] : found.surface.triangles) {
            const LimitQuery &p = found.places[a], &q = found.places[b], &r = found.places[c];
            if (p.cell != q.cell || p.cell != r.cell) continue;
            centres.push_back({p.cell, (p.uvw + q.uvw + r.uvw) / 3.0});
            means.push_back((found.fields[0].values[a] + found.fields[0].values[b] + found.fields[0].values[c]) / 3);
        }
        EXPECT_GT(centres.size(), found.surface.triangles.size() / 4);
        const LimitSamples samples = evaluate_limit(mesh, centres, {.scheme = {.crease_angle_deg = 40}});
        double error = 0;
        for (std::size_t i = 0; i < means.size(); ++i)
            error = std::max(error, std::abs(samples.attributes[0].values[i] - means[i]));
        return error;
    };
    const SurfaceOptions options{.scheme = {.crease_angle_deg = 40}, .boundary = true};
    const LimitSurface found = limit_surface(mesh, {}, options);
    EXPECT_EQ(found.report.level, 2);
    EXPECT_EQ(found.report.deviation_world, 0);
    expect_closed(found);
    EXPECT_LT(error_of_fields(found), 0.15);  // the curve rises by 1.25 above the chord between 10 and 10, at level 2 by .08
    EXPECT_LT(found.surface.triangles.size(), 2U * 2 * (8 * 3 + 3 * 2 + 8 * 2) * 16);  // where it does not bend, fewer
    // At the middles of edges the four-point rule: (-0 + 9·10 + 9·10 - 0) / 16 and (-0 + 9·0 + 9·0 - 10) / 16.
    const auto [low, high] = std::ranges::minmax(found.fields[0].values);
    EXPECT_NEAR(high, 11.25, 1e-9);
    EXPECT_LE(low, -0.625);
    EXPECT_GT(low, -0.7);
}

TEST(LimitSurface, TheBoundaryIsTheSameForAnyNumberOfThreads) {
    const HexMesh mesh = stairs(6, 2.9);
    const auto surface = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return limit_surface(mesh, {}, {.boundary = true});
    };
    const LimitSurface one = surface(1), four = surface(4);
    EXPECT_EQ(one.surface.triangles, four.surface.triangles);
    EXPECT_EQ(one.surface.points, four.surface.points);
    EXPECT_EQ(one.normals, four.normals);
}

TEST(LimitSurface, IsTheSameForAnyNumberOfThreads) {
    const HexMesh mesh = make_model("pawn", 12);
    const auto surface = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return limit_surface(mesh, "density", {.isos = {0.1}, .boundary = true});
    };
    const LimitSurface one = surface(1), four = surface(4);
    EXPECT_EQ(one.surface.triangles, four.surface.triangles);
    EXPECT_EQ(one.surface.points, four.surface.points);
    EXPECT_EQ(one.normals, four.normals);
}

class LimitSurfaceFiles : public test::TempFolder {};

TEST_F(LimitSurfaceFiles, FilesHaveAllTriangles) {
    HexMesh mesh = test::make_box(2, 2, 2);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    const LimitSurface found = limit_surface(mesh, {}, {.boundary = true});
    const SurfaceFileOptions colors{0, transfer_function_preset("viridis", 0, 2)};
    for (const char* name : {"a.ply", "a.stl", "a.vtp", "a.obj", "a.glb"}) {
        write_limit_surface(path(name), found, colors);
        EXPECT_GT(std::filesystem::file_size(path(name)), 400u) << name;
    }
    EXPECT_EQ(std::filesystem::file_size(path("a.stl")), 84 + 50 * found.surface.triangles.size());
    test::expect_error(ErrorCode::InvalidInput, ".glb", [&] { write_limit_surface(path("a.png"), found); });
}

TEST(LimitSurface, RefusesWhatMakesNoSense) {
    HexMesh mesh = test::make_box(1, 1, 1);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    const auto refused = [&](const std::string& what, const SurfaceOptions& options) {
        test::expect_error(ErrorCode::InvalidInput, what, [&] { (void)limit_surface(mesh, {}, options); });
    };
    refused("nothing", {});
    refused("finite", {.isos = {NAN}});
    refused("cap", {.boundary = true, .cap = true});
    refused("tolerance", {.boundary = true, .tolerance = 0});
    refused("level", {.boundary = true, .max_level = 9});
    test::expect_error(ErrorCode::InvalidInput, "g", [&] { (void)limit_surface(mesh, "g", {.isos = {0.5}}); });
    EXPECT_TRUE(limit_surface(mesh, "f", {.isos = {7}}).surface.triangles.empty());
}

}  // namespace limit_surface_test
}  // namespace subvol
