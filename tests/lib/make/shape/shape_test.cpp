// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "layers.h"
#include "lib/make/shape/shapes.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "lib/volume_of.h"
#include "shape_fitter.h"
#include "sharp_paths.h"
#include "subvol/control_mesh.h"
#include "subvol/detail/triangle_distance.h"
#include "subvol/mesh_report.h"

namespace subvol {
namespace shape_test {

using test::error_of;
using testing::HasSubstr;

double limit_volume(const HexMesh& mesh) {
    return test::volume_of(refine(mesh, {.levels = 2}));
}

TEST(FitShape, FindsTheFlatSidesOfABoxAgain) {
    HexMesh mesh = test::make_box(4, 4, 4);
    const Surface sides = boundary_surface(mesh);
    const Topology topology = build_topology(mesh);
    std::mt19937 dice(3);
    std::uniform_real_distribution<double> off(-0.15, 0.15);
    for (Index p = 0; p < mesh.points.size(); ++p) {
        if (topology.point_on_boundary[p] != 0) mesh.points[p] += Vec3(off(dice), off(dice), off(dice));
    }
    const ShapedMesh made = fit_shape(mesh, sides, {.rounds = 40, .stiffness = 1e-4, .folds = {.keep = true}});
    EXPECT_GT(made.report.before.rms, 0.03);
    EXPECT_LT(made.report.after.max, 1e-4);
    EXPECT_LT(made.report.after.missed_max, 1e-4);
    EXPECT_EQ(made.report.folds.proved, mesh.cells.size());
}

TEST(FitShape, ABlockBecomesABall) {
    HexMesh mesh = test::make_box(4, 4, 4);
    for (Vec3& x : mesh.points) {
        x = 0.5 * (x - 2.0);
        const double most = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
        if (glm::length(x) > 0) x *= 1 - 0.4 * most * (1 - most / glm::length(x));  // its corners are rounder than a box's
    }
    const Surface ball = test::sphere(24);
    const ShapedMesh made = fit_shape(mesh, ball, {.rounds = 40, .folds = {.keep = true}});
    EXPECT_GT(made.report.before.rms, 0.1);
    EXPECT_LT(made.report.after.rms, 0.01);
    EXPECT_LT(made.report.after.missed_rms, 0.01);
    EXPECT_GT(measure_cells(made.mesh).min_scaled_jacobian, 0);
    EXPECT_NEAR(limit_volume(made.mesh), 4 * std::numbers::pi / 3, 0.02);
}

TEST(FitShape, SaysHowFarAMeshIsFromASurface) {
    const HexMesh mesh = test::make_box(3, 3, 3);
    Surface sides = boundary_surface(mesh);
    const ShapeError same = shape_error(mesh, sides, {.kind = Scheme::Linear});
    EXPECT_LT(same.max, 1e-12);
    EXPECT_LT(same.missed_max, 1e-12);
    for (Vec3& x : sides.points) x += Vec3(.25, 0, 0);
    const ShapeError moved = shape_error(mesh, sides, {.kind = Scheme::Linear});
    EXPECT_NEAR(moved.max, .25, 1e-12);
    EXPECT_NEAR(moved.missed_max, .25, 1e-12);
}

TEST(ControlMesh, FillsABall) {
    const Surface ball = test::sphere(24);
    const ControlMesh made = control_mesh_of(ball, {.cells = 8});
    EXPECT_EQ(made.report.parts, 1U);
    EXPECT_EQ(made.report.shape.folds.folded, 0U);
    EXPECT_EQ(made.report.shape.folds.open, 0U);
    EXPECT_GT(made.report.min_scaled_jacobian, 0.3);
    EXPECT_LT(made.report.shape.after.max, 0.05 * made.report.side_world);
    EXPECT_LT(made.report.shape.after.missed_max, 0.05 * made.report.side_world);
    EXPECT_NEAR(limit_volume(made.mesh), 4 * std::numbers::pi / 3, 0.01);
}

TEST(ControlMesh, DoesNotDependOnTheSideThatIsOutsideNorOnThreads) {
    const Surface ball = test::sphere(10);
    const ControlMeshOptions options{.cells = 5, .rounds = 6};
    const HexMesh made = control_mesh_of(ball, options).mesh;
    Surface turned = ball;
    for (auto& t : turned.triangles) std::swap(t[0], t[1]);
    EXPECT_EQ(control_mesh_of(turned, options).mesh.cells, made.cells);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(control_mesh_of(ball, options).mesh.points, made.points);
}

TEST(ControlMesh, IsTheSameOfTrianglesThatShareNoPoints) {
    const Surface box = boundary_surface(test::make_box(2, 2, 2));
    Surface soup;
    for (const auto& t : box.triangles) {
        const auto first = static_cast<Index>(soup.points.size());
        for (const Index p : t) soup.points.push_back(box.points[p]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    const ControlMeshOptions options{.cells = 5, .rounds = 6};
    EXPECT_EQ(control_mesh_of(soup, options).mesh.points, control_mesh_of(box, options).mesh.points);
}

TEST(ControlMesh, SpansAHoleFreely) {
    Surface ball = test::sphere(16);
    std::erase_if(ball.triangles,
                  [&](const auto& t) { return std::ranges::all_of(t, [&](Index p) { return ball.points[p].z > 0.9; }); });
    const ControlMesh made = control_mesh_of(ball, {.cells = 10});
    const ShapeError& error = made.report.shape.after;
    EXPECT_LT(error.covered_rms, 0.1 * made.report.side_world);
    EXPECT_EQ(made.report.shape.folds.folded, 0U);
    // All of the boundary counts: its vertices of level 2 against each triangle.
    const HexMesh fine = refine(made.mesh, {.levels = 2});
    const Topology topology = build_topology(fine);
    double farthest = 0, highest_of_rim = 0;
    for (Index p = 0; p < fine.points.size(); ++p) {
        if (topology.point_on_boundary[p] == 0) continue;
        double nearest = std::numeric_limits<double>::infinity();
        for (const auto& t : ball.triangles) {
            const auto& x = ball.points;
            nearest = std::min(nearest, detail::squared_distance(fine.points[p], x[t[0]], x[t[1]], x[t[2]]));
        }
        farthest = std::max(farthest, std::sqrt(nearest));
    }
    for (const auto& t : ball.triangles) {
        for (const Index p : t) highest_of_rim = std::max(highest_of_rim, ball.points[p].z);
    }
    EXPECT_NEAR(error.max, farthest, 1e-9);
    EXPECT_GT(error.max, 2 * error.covered_max);
    // The hole of a ball beyond a height has the part (1 − z) / 2 of its area; the rim is a ring of squares.
    EXPECT_NEAR(error.hole_part, (1 - highest_of_rim) / 2, 0.03);
    std::map<std::pair<Index, Index>, int> sides;
    for (const auto& t : ball.triangles) {
        for (std::size_t k = 0; k < 3; ++k) ++sides[std::minmax(t[k], t[(k + 1) % 3])];
    }
    std::size_t open = 0;
    double length = 0;
    for (const auto& [side, count] : sides) {
        if (count != 1) continue;
        ++open;
        length += glm::distance(ball.points[side.first], ball.points[side.second]);
    }
    EXPECT_EQ(made.report.shape.open_edges, open);
    EXPECT_NEAR(made.report.shape.open_length_world, length, 1e-9);
    EXPECT_THAT(made.report.shape.warnings, testing::Contains(HasSubstr("the surface is open")));
    double highest = 0;
    for (const Vec3& x : made.mesh.points) highest = std::max(highest, x.z);
    EXPECT_GT(highest, 0.8);
}

TEST(ControlMesh, OfSpheresWithinEachOtherIsAShellWhateverTheirOrientation) {
    Surface shell = test::sphere(16);
    const auto first = static_cast<Index>(shell.points.size());
    for (const Vec3& x : test::sphere(16).points) shell.points.push_back(0.5 * x);
    for (const auto& t : test::sphere(16).triangles) shell.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    const ControlMesh made = control_mesh_of(shell, {.cells = 8});
    EXPECT_EQ(made.report.surface.cavities_alike, 1U);
    EXPECT_THAT(made.report.shape.warnings, testing::Contains(HasSubstr("taken as the walls of cavities")));
    EXPECT_NEAR(limit_volume(made.mesh), 4 * std::numbers::pi / 3 * (1 - 0.125), 0.05);
}

TEST(ControlMesh, OfBoxesThatCrossIsTheirUnion) {
    Surface boxes = boundary_surface(test::make_box(1, 1, 1));
    const Surface one = boxes;
    const auto first = static_cast<Index>(boxes.points.size());
    for (const Vec3& x : one.points) boxes.points.push_back(x + 0.5);
    for (const auto& t : one.triangles) boxes.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    const ControlMesh made = control_mesh_of(boxes, {.cells = 8});
    EXPECT_EQ(made.report.surface.united, 1U);
    EXPECT_FALSE(made.report.enclosed_world.has_value());
    EXPECT_NEAR(limit_volume(made.mesh), 1.875,
                0.06);  // the notch between the boxes has no creases, as they are not joined there
    // Drawn to the surface alone, the limit folds in ten cells at the notch, and the least scaled Jacobian is .01.
    EXPECT_LE(made.report.shape.folds.folded, 2U);
    EXPECT_GT(made.report.min_scaled_jacobian, 0.2);
}

TEST(ControlMesh, IsTheSameFarFromTheOrigin) {
    Surface ball = test::sphere(10);
    const ControlMeshOptions options{.cells = 5};
    const ControlMeshReport near = control_mesh_of(ball, options).report;
    for (Vec3& x : ball.points) x += Vec3(1e6, 2e6, 0);
    const ControlMeshReport far = control_mesh_of(ball, options).report;
    EXPECT_LT(far.shape.after.rms, 1.1 * near.shape.after.rms);
    EXPECT_LT(far.shape.after.missed_rms, 1.1 * near.shape.after.missed_rms);
}

/// A torus about the z axis.
Surface ring_of(double radius, double thickness) {
    Surface ring;
    constexpr int kAround = 48, kAcross = 20;
    for (int i = 0; i < kAround; ++i) {
        for (int j = 0; j < kAcross; ++j) {
            const double a = 2 * std::numbers::pi * i / kAround, b = 2 * std::numbers::pi * j / kAcross;
            const double r = radius + thickness * std::cos(b);
            ring.points.emplace_back(r * std::cos(a), r * std::sin(a), thickness * std::sin(b));
            const auto at = [](int u, int v) { return static_cast<Index>(u % kAround * kAcross + v % kAcross); };
            ring.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            ring.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return ring;
}

TEST(ControlMesh, OfARingHasItsHole) {
    const Surface ring = ring_of(2, 0.7);
    const ControlMesh made = control_mesh_of(ring, {.cells = 16});
    const Topology topology = build_topology(made.mesh);
    long points = 0, edges = 0, faces = 0;
    for (Index p = 0; p < topology.point_count; ++p) points += topology.point_on_boundary[p];
    for (Index e = 0; e < topology.edges.size(); ++e) edges += topology.edge_on_boundary[e];
    for (Index f = 0; f < topology.faces.size(); ++f) faces += topology.face_on_hull(f) ? 1 : 0;
    EXPECT_EQ(points - edges + faces, 0);  // the Euler number of a torus
    EXPECT_EQ(made.report.shape.folds.folded, 0U);
    EXPECT_LT(made.report.shape.after.rms, 0.03 * made.report.side_world);
}

// Drawn to the surface alone, its cells have a scaled Jacobian of .07.
TEST(ControlMesh, OfAThinBodyHasNoFlatCells) {
    Surface body = test::sphere(12);
    for (Vec3& x : body.points) x *= Vec3(1, 0.15, 0.12);
    const ControlMesh made = control_mesh_of(body, {.cells = 12});
    EXPECT_EQ(made.report.shape.folds.folded, 0U);
    EXPECT_GE(made.report.min_scaled_jacobian, 0.3);
    EXPECT_GT(measure_cells(refine(made.mesh, {.levels = 3})).min_scaled_jacobian, 0);
    EXPECT_LT(made.report.shape.after.rms, 0.15 * made.report.side_world);
    // What that costs is said.
    EXPECT_NEAR(made.report.enclosed_world.value(), 4 * std::numbers::pi / 3 * 0.15 * 0.12, 1e-3);
    EXPECT_NEAR(made.report.shape.volume_world, limit_volume(made.mesh), 1e-3 * made.report.shape.volume_world);
    EXPECT_GT(made.report.shape.volume_world, 1.02 * made.report.enclosed_world.value());
    EXPECT_THAT(made.report.shape.warnings.at(0), HasSubstr("% more than the surface"));
}

// The cells at its edge of 25° are flat, as the edge is sharp; at the ends of the edge the limit would fold, and leaves it.
TEST(ControlMesh, KeepsAnAcuteEdgeWhereItsCellsDoNotFold) {
    const double height = 2 * std::tan(25 * std::numbers::pi / 180);
    const Surface wedge{{{0, 0, 0}, {2, 0, 0}, {2, height, 0}, {0, 0, 1}, {2, 0, 1}, {2, height, 1}},
                        {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}}};
    const ControlMesh made = control_mesh_of(wedge, {.cells = 12});
    EXPECT_EQ(made.report.shape.folds.folded, 0U);
    EXPECT_GT(made.report.min_scaled_jacobian, 0.05);
    EXPECT_LT(made.report.sharp.rms, 0.1 * made.report.side_world);
    EXPECT_LT(made.report.sharp.max, 0.5 * made.report.side_world);
    EXPECT_NEAR(made.report.enclosed_world.value(), height, 1e-12);
    EXPECT_NEAR(made.report.shape.volume_world, limit_volume(made.mesh), 1e-3 * height);
    EXPECT_NEAR(limit_volume(made.mesh), height, 2e-2 * height);
}

/// A box turned in space, so that no cube has its directions.
Surface turned_box(const Vec3& size) {
    Surface box = boundary_surface(test::make_box(2, 2, 2));
    for (Vec3& x : box.points) {
        x *= 0.5 * size;
        x = {x.x * std::cos(.5) - x.y * std::sin(.5), x.x * std::sin(.5) + x.y * std::cos(.5), x.z};
        x = {x.x, x.y * std::cos(.35) - x.z * std::sin(.35), x.y * std::sin(.35) + x.z * std::cos(.35)};
    }
    return box;
}

TEST(ControlMesh, KeepsTheEdgesOfABox) {
    const Surface box = turned_box({1, 1, 1});
    const ControlMesh made = control_mesh_of(box, {.cells = 10});
    const ControlMeshReport& found = made.report;
    EXPECT_EQ(found.sharp.curves, 12U);
    EXPECT_EQ(found.sharp.missed, 0U);
    EXPECT_NEAR(found.sharp.length_world, 12, 1e-9);
    EXPECT_EQ(found.sharp.creases, made.mesh.creases.size());
    EXPECT_LT(found.sharp.max, 0.02 * found.side_world);
    EXPECT_LT(found.shape.after.max, 0.02 * found.side_world);
    EXPECT_LT(found.shape.after.missed_max, 0.02 * found.side_world);
    EXPECT_NEAR(limit_volume(made.mesh), 1, 2e-3);
    EXPECT_EQ(found.shape.folds.folded, 0U);
    EXPECT_GT(found.min_scaled_jacobian, 0.3);

    const ControlMesh round = control_mesh_of(box, {.cells = 10, .sharp_angle_deg = 180});
    EXPECT_EQ(round.report.sharp.curves, 0U);
    EXPECT_GT(round.report.shape.after.missed_max, 4 * found.shape.after.missed_max);
}

TEST(SharpPaths, PathsMeetInCornersAlone) {
    const Surface box = turned_box({2, 1, 1});
    const detail::SharpEdges sharp = detail::sharp_edges({&box}, 40, 0.1);
    ASSERT_EQ(sharp.curves.size(), 12U);
    ASSERT_EQ(sharp.corners.size(), 8U);
    const HexMesh mesh = control_mesh_of(box, {.cells = 16, .rounds = 4, .sharp_angle_deg = 180, .folds = {.keep = true}}).mesh;
    const detail::SharpPaths paths = detail::sharp_paths(mesh, sharp, 0.12);
    EXPECT_TRUE(paths.missed.empty());
    std::map<Index, std::size_t> edges;
    for (const auto& crease : paths.creases) {
        for (const Index p : crease) ++edges[p];
    }
    std::set<Index> corners;
    for (const auto& [point, corner] : paths.corners) corners.insert(point);
    EXPECT_EQ(corners.size(), 8U);
    for (const auto& [point, count] : edges) EXPECT_EQ(count, corners.contains(point) ? 3U : 2U);

    // Each point of a path has one more edge on either side; each cell has at most one side at the boundary, and that at most
    // one edge of the paths, but at corners.
    const HexMesh layered = detail::with_layer_along(mesh, paths.creases).mesh;
    const Topology topology = build_topology(layered);
    const std::set<std::array<Index, 2>> creases(paths.creases.begin(), paths.creases.end());
    for (const auto& [point, count] : edges) {
        std::size_t around = 0;
        for (const Index e : topology.point_edges[point]) around += topology.edge_on_boundary[e];
        EXPECT_EQ(around, 2 * count);
    }
    for (Index f = 0; f < topology.faces.size(); ++f) {
        if (!topology.face_on_hull(f)) continue;
        std::size_t sides = 0;
        for (const Index e : topology.face_edges[f]) sides += creases.contains(topology.edges[e]) ? 1 : 0;
        EXPECT_LE(sides, 1U);
    }
    // A side of the boundary is new on both sides of each crease, and a point for each edge at a point of a path.
    const auto sides_of = [](const Topology& t) {
        std::size_t sides = 0;
        for (Index f = 0; f < t.faces.size(); ++f) sides += t.face_on_hull(f) ? 1 : 0;
        return sides;
    };
    const auto points_of = [](const Topology& t) {
        return static_cast<std::size_t>(std::ranges::count(t.point_on_boundary, 1));
    };
    const Topology before = build_topology(mesh);
    EXPECT_EQ(sides_of(topology), sides_of(before) + 2 * creases.size());
    EXPECT_EQ(points_of(topology), points_of(before) + 2 * creases.size());
}

TEST(SharpEdges, NoiseIsNone) {
    Surface ball = test::sphere(24);
    std::mt19937 dice(7);
    std::uniform_real_distribution<double> off(-0.02, 0.02);
    for (Vec3& x : ball.points) x *= 1 + off(dice);
    EXPECT_TRUE(detail::sharp_edges({&ball}, 40, 0.2).curves.empty());
    // A ring that is bent: the rim of a half ball, whose points are not shared by the two sides.
    Surface half = test::sphere(24);
    for (Vec3& x : half.points) x.z = std::max(x.z, 0.0);
    const detail::SharpEdges rim = detail::sharp_edges({&half}, 40, 0.2);
    ASSERT_EQ(rim.curves.size(), 1U);
    EXPECT_TRUE(rim.curves[0].closed());
    EXPECT_NEAR(rim.curves[0].length(), 2 * std::numbers::pi, 0.1);
}

TEST(ControlMesh, SaysWhatIsWrong) {
    Surface surface = test::sphere(4);
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(surface, {.cells = 1}); }), HasSubstr("cells: 1 is out of range"));
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(surface, {.cells = 100, .max_cells = 1000}); }),
                HasSubstr("cells: the grid would have too many cubes"));
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(surface, {.cells = 20, .max_cells = 1000}); }),
                HasSubstr("cells: there would be"));
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of({surface.points, {}}); }), HasSubstr("has no triangles"));
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(surface, {.scheme = {.crease_angle_deg = 30}}); }),
                HasSubstr("crease_angle: has no effect"));
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(test::sphere(4, 1e200)); }), HasSubstr("has no size that can be"));
    Surface flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(flat); }), HasSubstr("no cell has its middle inside"));
    const Surface sheet{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(sheet, {.cells = 8}); }), HasSubstr("encloses no volume"));
    Surface far = test::sphere(4);
    for (Vec3& x : far.points) x += 1e12;
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(far); }), HasSubstr("cells away from the origin"));
    // 4 π/3 (490/2)³ cells, which the volume shows before any place is looked at
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(test::sphere(12), {.cells = 490}); }),
                HasSubstr("there would be 6"));
    surface.triangles[3][1] = 99999;
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(surface); }), HasSubstr("triangle 3 has the corner 99999"));
    surface = test::sphere(4);
    surface.points[surface.triangles[0][0]].x = NAN;
    EXPECT_THAT(error_of([&] { std::ignore = fit_shape(test::make_box(2, 2, 2), surface); }), HasSubstr("is not finite"));
}

TEST(ShapeFitter, TurnsACellBackThatWasTurnedInsideOut) {
    HexMesh mesh = test::make_box(3, 3, 3);
    const Surface sides = boundary_surface(mesh);
    const Index inner = 1 + 4 * (1 + 4 * 1);
    mesh.points[inner] += Vec3(1.6, 1.6, 1.6);
    ASSERT_LT(measure_cells(mesh).min_scaled_jacobian, 0);
    const detail::WallTarget target{&sides};
    const detail::ShapeFitter fitter(build_topology(mesh), {{}, {&target, 1}}, {.kind = Scheme::Linear});
    const std::vector<double> ones(mesh.cells.size(), 1);
    for (int k = 0; k < 3; ++k) mesh.points = fitter.relaxed(mesh.points, {ones, ones}, 10);
    EXPECT_GT(measure_cells(mesh).min_scaled_jacobian, 0.5);
}

}  // namespace shape_test
}  // namespace subvol
