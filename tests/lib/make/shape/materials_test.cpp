// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "lib/make/shape/shapes.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "lib/volume_of.h"
#include "mesh_walls.h"
#include "subvol/control_mesh.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/limit.h"
#include "subvol/refine.h"

namespace subvol {
namespace materials_test {

using test::error_of;
using testing::HasSubstr;

Surface moved(Surface surface, const Vec3& by) {
    for (Vec3& x : surface.points) x += by;
    return surface;
}

Surface box(const Vec3& lower, const Vec3& upper, int cells = 6) {
    return test::moved_box(cells, [&](const Vec3& x) { return lower + 0.5 * (x + 1.0) * (upper - lower); });
}

Surface joined(Surface a, const Surface& b) {
    const auto first = static_cast<Index>(a.points.size());
    a.points.insert(a.points.end(), b.points.begin(), b.points.end());
    for (const auto& t : b.triangles) a.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    return a;
}

/// The volume of a set's cells in the limit, each by the points of level 2.
double volume_of_set(const ControlMesh& made, std::string_view name) {
    std::vector<std::uint8_t> kept(made.mesh.cells.size() * 64, 0);
    for (const Index c : find_set(made.sets, name).cells)
        std::fill_n(kept.begin() + 64 * static_cast<std::ptrdiff_t>(c), 64, 1);
    HexMesh fine = refine(made.mesh, {.levels = 2});
    HexMesh part{fine.points, {}, {}, {}, {}};
    for (std::size_t c = 0; c < kept.size(); ++c) {
        if (kept[c] != 0) part.cells.push_back(fine.cells[c]);
    }
    return test::volume_of(part);
}

/// The points of faces between two materials.
std::vector<Vec3> places_between(const ControlMesh& made) {
    std::vector<std::uint8_t> used(made.mesh.points.size(), 0);
    for (const auto& face : made.mesh.sharp_faces) {
        for (const Index p : face) used[p] = 1;
    }
    std::vector<Vec3> places;
    for (std::size_t p = 0; p < used.size(); ++p) {
        if (used[p] != 0) places.push_back(made.mesh.points[p]);
    }
    return places;
}

constexpr double kBall = 4 * std::numbers::pi / 3;

TEST(Materials, ABodyWithinAnotherIsCutOutOfItWhateverTheirOrder) {
    const std::vector<MaterialSurface> given{{"whole", test::sphere(24)}, {"core", test::sphere(16, 0.5)}};
    const ControlMesh made = control_mesh_of(given, {.cells = 8});
    ASSERT_EQ(made.sets.sets.size(), 2U);
    EXPECT_EQ(made.sets.sets[0].name, "whole");
    EXPECT_EQ(made.sets.sets[0].cells.size() + made.sets.sets[1].cells.size(), made.mesh.cells.size());
    EXPECT_NEAR(volume_of_set(made, "core"), kBall / 8, 0.02);
    EXPECT_NEAR(volume_of_set(made, "whole"), kBall * 7 / 8, 0.03);
    // The report's has flat triangles at the walls, the other one the bent sides of cells.
    EXPECT_NEAR(made.report.materials[0].volume_world, volume_of_set(made, "whole"), 1e-4);
    ASSERT_TRUE(made.report.materials[0].enclosed_world && made.report.materials[1].enclosed_world);
    EXPECT_NEAR(*made.report.materials[0].enclosed_world, enclosed_volume(given[0].surface) - enclosed_volume(given[1].surface),
                1e-9);
    EXPECT_TRUE(made.report.shape.is_sound());
    // The wall between them is a surface of the mesh, on the small sphere.
    ASSERT_GT(made.mesh.sharp_faces.size(), 20U);
    for (const Vec3& x : places_between(made)) EXPECT_NEAR(glm::length(x), 0.5, 0.01);

    const std::vector<MaterialSurface> turned{given[1], given[0]};
    const ControlMesh other = control_mesh_of(turned, {.cells = 8});
    EXPECT_EQ(other.mesh.points, made.mesh.points);
    EXPECT_EQ(find_set(other.sets, "core").cells, find_set(made.sets, "core").cells);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(control_mesh_of(given, {.cells = 8}).mesh.points, made.mesh.points);
}

TEST(Materials, TurnedTrianglesDoNotMakeABodySmaller) {
    // With two of five triangles turned, the sum of the triangles' volumes is a fifth of what they enclose.
    std::vector<MaterialSurface> given{{"whole", test::sphere(16)}, {"core", test::sphere(12, 0.6)}};
    for (std::size_t t = 0; t < given[0].surface.triangles.size(); ++t) {
        if (t % 5 < 2) std::swap(given[0].surface.triangles[t][1], given[0].surface.triangles[t][2]);
    }
    ASSERT_LT(std::abs(enclosed_volume(given[0].surface)), enclosed_volume(given[1].surface));
    const ControlMesh made = control_mesh_of(given, {.cells = 10, .folds = {.keep = true}});
    EXPECT_NEAR(volume_of_set(made, "core"), kBall * std::pow(0.6, 3), 0.05);
    EXPECT_NEAR(volume_of_set(made, "whole"), kBall * (1 - std::pow(0.6, 3)), 0.1);
    EXPECT_THAT(made.report.shape.warnings, testing::Contains(HasSubstr("whole: ")));
}

TEST(Materials, BodiesThatTouchInAFaceShareIt) {
    const std::vector<MaterialSurface> given{{"left", box({0, 0, 0}, {1, 1, 1})}, {"right", box({1, 0, 0}, {2.5, 1, 1})}};
    const ControlMesh made = control_mesh_of(given, {.cells = 10});
    EXPECT_EQ(made.report.parts, 1U);
    EXPECT_EQ(made.report.sharp.curves, 20U);  // the four edges of the shared side once
    EXPECT_EQ(made.report.sharp.missed, 0U);
    EXPECT_NEAR(volume_of_set(made, "left"), 1, 0.002);
    EXPECT_NEAR(volume_of_set(made, "right"), 1.5, 0.003);
    EXPECT_LT(made.report.shape.after.max, 0.01);
    EXPECT_LT(made.report.shape.after.missed_max, 0.01);
    EXPECT_TRUE(made.report.shape.is_sound());
    EXPECT_TRUE(made.report.shape.warnings.empty());
    ASSERT_GT(made.mesh.sharp_faces.size(), 20U);
    for (const Vec3& x : places_between(made)) EXPECT_NEAR(x.x, 1, 0.005);
    // Each point of the shared side is one of both, so there are no gaps.
    const Surface hull = boundary_surface(made.mesh);
    EXPECT_NEAR(enclosed_volume(hull), 2.5, 0.01);
}

TEST(Materials, WhatTwoBodiesShareIsOfTheSmallerOne) {
    const std::vector<MaterialSurface> given{{"large", test::sphere(24)}, {"small", moved(test::sphere(24, 0.7), {1.3, 0, 0})}};
    const ControlMesh made = control_mesh_of(given, {.cells = 14});
    // The lens of two balls with radii R, r whose middles are d apart.
    const double R = 1, r = 0.7, d = 1.3;
    const double lens =
        std::numbers::pi * std::pow(R + r - d, 2) * (d * d + 2 * d * (R + r) - 3 * std::pow(R - r, 2)) / (12 * d);
    EXPECT_NEAR(volume_of_set(made, "large"), kBall - lens, 0.02);
    EXPECT_NEAR(volume_of_set(made, "small"), kBall * std::pow(r, 3), 0.02);
    EXPECT_FALSE(made.report.materials[0].enclosed_world.has_value());
    EXPECT_TRUE(made.report.materials[1].enclosed_world.has_value());
    EXPECT_FALSE(made.report.enclosed_world.has_value());
    EXPECT_THAT(made.report.shape.warnings,
                testing::Contains(HasSubstr("small and large cross: what both enclose is small, which encloses less")));
    EXPECT_TRUE(made.report.shape.is_sound());
    EXPECT_LT(made.report.shape.after.rms, 0.05 * made.report.side_world);
}

TEST(Materials, SurfacesOfOneFaceWithOtherTrianglesTouch) {
    // A face that is wavy, by 12 × 12 squares of one body and 13 × 13 of the other: gaps and overlaps of a hundredth of a cell.
    const auto wave = [](const Vec3& x) { return 0.15 * std::sin(2 * x.x) * std::cos(1.5 * x.y); };
    const auto layer = [&](int cells, double sign) {
        return test::moved_box(cells, [&](const Vec3& x) {
            const double part = 0.5 * (1 + sign * x.z), low = wave(x);  // 0 at the wavy face
            return Vec3(x.x, x.y, low + part * (sign - low));
        });
    };
    const std::vector<MaterialSurface> given{{"lower", layer(12, -1)}, {"upper", layer(13, 1)}};
    const ControlMesh made = control_mesh_of(given, {.cells = 9});
    EXPECT_EQ(made.report.parts, 1U);
    EXPECT_TRUE(made.report.shape.is_sound());
    EXPECT_TRUE(made.report.shape.warnings.empty()) << made.report.shape.warnings.front();
    EXPECT_LT(made.report.shape.after.max, 0.05 * made.report.side_world);
    EXPECT_LT(made.report.shape.after.missed_max, 0.05 * made.report.side_world);
    // The wave has as much above as below.
    EXPECT_NEAR(volume_of_set(made, "lower"), 4, 0.01);
    EXPECT_NEAR(volume_of_set(made, "upper"), 4, 0.01);
    for (const Vec3& x : places_between(made)) EXPECT_NEAR(x.z, wave(x), 0.01);
    EXPECT_NEAR(enclosed_volume(boundary_surface(made.mesh)), 8, 0.01);
}

TEST(Materials, BadOnesAreRefused) {
    const Surface ball = test::sphere(8);
    EXPECT_THAT(error_of([&] {
                    std::ignore = control_mesh_of(std::vector<MaterialSurface>{{"a", ball}, {"a", ball}}, {.cells = 8});
                }),
                HasSubstr("a: two materials have this name"));
    EXPECT_THAT(error_of([&] {
                    std::ignore = control_mesh_of(std::vector<MaterialSurface>{{"a", ball}, {"b", ball}}, {.cells = 8});
                }),
                HasSubstr("b: no cell has its middle inside the part of the surface that no smaller one encloses"));
    EXPECT_THAT(error_of([&] { std::ignore = control_mesh_of(std::vector<MaterialSurface>{}, {.cells = 8}); }),
                HasSubstr("there is no surface"));
    EXPECT_THAT(error_of([&] {
                    std::ignore = control_mesh_of(std::vector<MaterialSurface>{{"", ball}, {"b", ball}}, {.cells = 8});
                }),
                HasSubstr("a material has no name"));
}

TEST(ControlMesh, WallsWithinAUnionDrawNothing) {
    const double R = 1, d = 1.2;
    const ControlMesh balls = control_mesh_of(joined(test::sphere(24), moved(test::sphere(24), {d, 0, 0})), {.cells = 12});
    const double lens = std::numbers::pi * std::pow(2 * R - d, 2) * (d * d + 4 * d * R) / (12 * d);
    EXPECT_NEAR(test::volume_of(refine(balls.mesh, {.levels = 2})), 2 * kBall - lens, 0.03);
    EXPECT_LT(balls.report.shape.after.max, 0.1 * balls.report.side_world);
    EXPECT_LT(balls.report.shape.after.missed_max, 0.15 * balls.report.side_world);
    const ControlMesh boxes = control_mesh_of(joined(box({0, 0, 0}, {1, 1, 1}), box({1, 0, 0}, {2, 1, 1})), {.cells = 8});
    EXPECT_LT(boxes.report.shape.after.max, 0.02 * boxes.report.side_world);
    EXPECT_LT(boxes.report.shape.after.missed_max, 0.02 * boxes.report.side_world);
    EXPECT_EQ(boxes.report.parts, 1U);
    // A box on a side of another one: the ring where they meet is an edge.
    const ControlMesh knob =
        control_mesh_of(joined(box({0, 0, 0}, {1, 1, 1}), box({1, .25, .25}, {2, .75, .75})), {.cells = 8});
    EXPECT_EQ(knob.report.sharp.curves, 24U);
    EXPECT_EQ(knob.report.sharp.missed, 0U);
    EXPECT_LT(knob.report.shape.after.max, 0.03 * knob.report.side_world);
    EXPECT_NEAR(test::volume_of(refine(knob.mesh, {.levels = 2})), 1.25, 0.005);
}

TEST(ControlMesh, SaysWhichPartOfTheSurfaceItReaches) {
    const ControlMesh cube = control_mesh_of(box({0, 0, 0}, {1, 1, 1}), {.cells = 5});
    EXPECT_EQ(cube.report.sharp.corners, 8U);
    EXPECT_EQ(cube.report.sharp.missed_corners, 0U);
    EXPECT_EQ(cube.report.shape.after.reached_part, 1);
    // A cube of cells with the side .25, and a plate beside it that it does not have: only what is nearer than .125 is reached.
    HexMesh cells = test::make_box(4, 4, 4);
    for (Vec3& x : cells.points) x *= 0.25;
    const Surface plate = box({1, .3, .61}, {1.5, .7, .62}, 40);
    const double area = 2 * (.4 + .01) * .5 + 2 * .4 * .01, reached = 2 * (.4 + .01) * .125 + .4 * .01;
    EXPECT_NEAR(shape_error(cells, plate, {.kind = Scheme::Linear}).reached_part, reached / area, 0.01);
}

TEST(ControlMesh, SidesOverHolesAreThePatchLid) {
    Surface ball = test::sphere(24);
    EXPECT_TRUE(control_mesh_of(ball, {.cells = 8}).sets.empty());
    std::erase_if(ball.triangles,
                  [&](const auto& t) { return std::ranges::all_of(t, [&](Index p) { return ball.points[p].z > 0.8; }); });
    const ControlMesh made = control_mesh_of(ball, {.cells = 10});
    ASSERT_EQ(made.sets.patches.size(), 1U);
    const Patch& lid = find_patch(made.sets, "lid");
    EXPECT_EQ(made.report.lid_sides, lid.sides.size());
    validate(made.sets, made.mesh);
    double area = 0;
    for (const CellSide& at : lid.sides) {
        std::array<Vec3, 4> x;
        for (std::size_t k = 0; k < 4; ++k) x[k] = made.mesh.points[made.mesh.cells[at.cell][kCellFaces[at.side][k]]];
        area += glm::length(glm::cross(x[2] - x[0], x[3] - x[1])) / 2;
        for (const Vec3& place : x) EXPECT_GT(place.z, 0.6);
    }
    EXPECT_NEAR(area, std::numbers::pi * (1 - 0.8 * 0.8), 0.25);
}

}  // namespace materials_test
}  // namespace subvol
