// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_motion.h"
#include "subvol/spread_vectors.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "subvol/error.h"
#include "subvol/limit_level.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"
#include "vdb/each_voxel.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace mesh_motion_test {

using namespace test;

HexMesh turned(HexMesh mesh, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    for (Vec3& p : mesh.points) p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    return mesh;
}

/// The components of the velocity as separate fields, which can be read without OpenVDB.
std::array<VdbGrid, 3> velocity_grids(HexMesh mesh, const Attribute& velocity, const RasterizeOptions& options) {
    const std::vector<std::string> names{"x", "y", "z"};
    mesh.attributes.clear();
    for (std::size_t d = 0; d < 3; ++d) {
        mesh.attributes.push_back({names[d], 1, {}});
        for (std::size_t i = d; i < velocity.values.size(); i += 3) mesh.attributes[d].values.push_back(velocity.values[i]);
    }
    auto grids = rasterize(mesh, names, options);
    return {std::move(grids[0]), std::move(grids[1]), std::move(grids[2])};
}

// A central difference of a rotation by ±a is sin(a)/a times the velocity ω × r, and linear in r: the scheme and the cells'
// maps reproduce it. The tolerance is the rounding of a float at 1.
TEST(MeshMotion, VelocityOfATurningBallIsOfSecondOrder) {
    const HexMesh ball = ball_mesh(4);
    double last = 0;
    for (const double angle : {0.2, 0.1}) {
        const Attribute velocity = velocity_between(turned(ball, -angle), turned(ball, angle), 2);
        EXPECT_EQ(velocity.name, "vel");
        EXPECT_EQ(velocity.channels, 3);
        const auto grids = velocity_grids(ball, velocity, {.resolution = 50, .refine = {.levels = 2}});
        const double h = grids[0].report().voxel_size_world;
        double most = 0;
        for_each_voxel(grids[0], [&](const Voxel& v, double x) {
            const Vec3 r = h * Vec3(v[0], v[1], v[2]);
            const Vec3 found(x, *grids[1].value(r), *grids[2].value(r));
            const Vec3 exact = std::sin(angle) * Vec3(-r.y, r.x, 0.0);
            ASSERT_LT(glm::length(found - exact), 1e-7);
            most = std::max(most, glm::length(found - angle * Vec3(-r.y, r.x, 0.0)) / angle);
        });
        EXPECT_LT(most, angle * angle / 6);
        if (last > 0) {
            EXPECT_NEAR(last / most, 4, 0.1);
        }
        last = most;
    }
}

// The velocity of a rotation about the box's corner: each layer has means of the layers before, so no velocity grows.
TEST(MeshMotion, VelocitiesReachBeyondTheVolume) {
    HexMesh box = box_mesh(2);
    box.attributes.push_back(velocity_between(turned(box, -0.1), turned(box, 0.1), 2));
    const std::vector<std::string> names{"vel"};
    const auto grids = rasterize(box, names, {.resolution = 20});
    const GridReport& inside = grids[0].report();
    ASSERT_EQ(inside.active_voxels, 20u * 20u * 20u);
    const double h = inside.voxel_size_world;
    for (const int layers : {0, 1, 5}) {
        SCOPED_TRACE(layers);
        const auto side = static_cast<std::size_t>(20 + 2 * layers);
        const VdbGrid spread = spread_vectors(grids[0], layers);
        const GridReport& outside = spread.report();
        EXPECT_EQ(outside.name, "vel");
        EXPECT_EQ(outside.active_voxels, side * side * side);
        EXPECT_NEAR(glm::distance(outside.bounds.lower, inside.bounds.lower - layers * h), 0, 1e-6 * h);
        EXPECT_NEAR(glm::distance(outside.bounds.upper, inside.bounds.upper + layers * h), 0, 1e-6 * h);
        EXPECT_EQ(outside.max, inside.max);  // at the far edge; a mean of different vectors is shorter
    }
}

TEST(MeshMotion, OnlyVectorsReachFurther) {
    const auto mesh = with_field(box_mesh(2), "f", [](const Vec3&) { return 1.0; });
    const std::vector<std::string> field{"f"};
    const auto grids = rasterize(mesh, field, {.resolution = 10});
    EXPECT_THROW((void)spread_vectors(grids[0], 1), Error);
    HexMesh moved = mesh;
    moved.attributes = {velocity_between(mesh, mesh, 1)};
    const std::vector<std::string> velocity{"vel"};
    const auto still = rasterize(moved, velocity, {.resolution = 10});
    EXPECT_THROW((void)spread_vectors(still[0], -1), Error);
    EXPECT_THROW((void)spread_vectors(still[0], 1001), Error);
    EXPECT_EQ(spread_vectors(still[0], 2).report().max, 0);
}

TEST(MeshMotion, NeedsTheSameCells) {
    const HexMesh a = box_mesh(2), b = box_mesh(3);
    HexMesh creased = a;
    creased.creases.push_back({0, 1});
    EXPECT_TRUE(same_cells(a, turned(a, 1)));
    EXPECT_FALSE(same_cells(a, b));
    EXPECT_FALSE(same_cells(a, creased));
    EXPECT_TRUE(moved_cells(a, creased));
    EXPECT_NO_THROW((void)velocity_between(a, creased, 1));
    EXPECT_THROW((void)velocity_between(a, b, 1), Error);
    EXPECT_THROW((void)velocity_between(a, a, 0), Error);
}

/// A grid's voxels with the bits of their values.
std::vector<std::pair<Voxel, double>> list(const VdbGrid& grid) {
    std::vector<std::pair<Voxel, double>> all;
    for_each_voxel(grid, [&](const Voxel& v, double value) { all.emplace_back(v, value); });
    return all;
}

/// Compares a frame's grids without tables and with those of the first frame; the first and the last grid bit by bit.
void expect_same_by_tables(const HexMesh& first, const HexMesh& later, RasterizeOptions options) {
    const std::vector<std::string> field{"f"};
    const auto alone = rasterize(later, field, options);
    const RefinementTables tables = rasterization_tables(first, options);
    options.tables = &tables;
    const auto shared = rasterize(later, field, options);
    ASSERT_EQ(alone.size(), shared.size());
    EXPECT_GT(alone.front().report().active_voxels, 10000u);
    EXPECT_TRUE(list(alone.front()) == list(shared.front()));
    EXPECT_EQ(alone[1].report().max, shared[1].report().max);
    EXPECT_TRUE(list(alone.back()) == list(shared.back()));
}

// Frames of a sequence share the tables of the first one; the grids have the same bits as without tables.
TEST(MeshMotion, SharedTablesGiveTheSameGrids) {
    const HexMesh first = jittered_box_mesh(4);
    const HexMesh later =
        with_field(turned(first, 0.3), "f", [](const Vec3& p) { return std::sin(5 * p.x) * std::cos(4 * p.y) + p.z; });
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear}) {
        for (const int levels : {0, 1, 2}) {
            SCOPED_TRACE(levels);
            expect_same_by_tables(first, later,
                                  {.voxel_size_world = 0.027,
                                   .refine = {.scheme = {scheme}, .levels = levels},
                                   .on_limit = !interpolates(scheme),
                                   .cell_numbers = true,
                                   .level_set = LevelSetOptions{}});
        }
    }
}

// The same for curved cells of the limit, whose nodes have one level with tables.
TEST(MeshMotion, SharedTablesOfTheLimit) {
    const HexMesh first = jittered_box_mesh(4);
    const HexMesh later = with_field(turned(first, 0.3), "f", [](const Vec3& p) { return std::sin(5 * p.x) + p.z; });
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        const LimitCells limit{.level = 1, .cell_levels = std::vector<std::uint8_t>(first.cells.size(), 2)};
        expect_same_by_tables(
            first, later,
            {.voxel_size_world = 0.027, .refine = {.scheme = {scheme}}, .limit = &limit, .level_set = LevelSetOptions{}});
    }
}

TEST(MeshMotion, TablesOfAnotherMeshAreRefused) {
    const auto mesh = with_field(box_mesh(3), "f", [](const Vec3&) { return 1.0; });
    const std::vector<std::string> field{"f"};
    RasterizeOptions options{.resolution = 10, .refine = {.levels = 1}};
    const RefinementTables tables = rasterization_tables(mesh, options);
    options.tables = &tables;
    EXPECT_NO_THROW((void)rasterize(mesh, field, options));
    options.refine.levels = 2;
    EXPECT_THROW((void)rasterize(mesh, field, options), Error);
    options.refine.levels = 1;
    HexMesh turned_cell = mesh;
    turned_cell.cells[5] = {turned_cell.cells[5][1], turned_cell.cells[5][2], turned_cell.cells[5][3], turned_cell.cells[5][0],
                            turned_cell.cells[5][5], turned_cell.cells[5][6], turned_cell.cells[5][7], turned_cell.cells[5][4]};
    EXPECT_THROW((void)rasterize(turned_cell, field, options), Error);
}

}  // namespace mesh_motion_test
}  // namespace subvol
