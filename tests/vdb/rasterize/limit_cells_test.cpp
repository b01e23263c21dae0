// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

#include "lib/random_vector.h"
#include "subvol/error.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_report.h"
#include "subvol/model.h"
#include "subvol/rasterize.h"
#include "subvol/refine.h"
#include "subvol/vdb_grid.h"
#include "vdb/each_voxel.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace limit_cells_test {

using namespace test;

const std::vector<std::string> kField{"f"};

std::map<Voxel, double> values_of(const VdbGrid& grid) {
    std::map<Voxel, double> values;
    for_each_voxel(grid, [&](const Voxel& v, double value) { values[v] = value; });
    return values;
}

VdbGrid rasterized(const HexMesh& mesh, double voxel, const LimitCells& limit) {
    return std::move(rasterize(mesh, kField, {.voxel_size_world = voxel, .limit = &limit}).front());
}

// MCQ reproduces quadratics, up to the boundary and at its edges: cells of 27 nodes are its limit itself. The tolerance is a
// float's rounding and Newton's tolerance.
TEST(LimitCells, AreExactWhereTheLimitIsQuadratic) {
    const auto bent = [](const Vec3& q) {
        return Vec3(q.x + 0.2 * q.y * q.y - 0.1 * q.x * q.z, q.y + 0.15 * q.x * q.x, q.z + 0.1 * q.x * q.y + 0.2 * q.y * q.y);
    };
    const auto value = [](const Vec3& q) { return 0.3 + q.x * q.x - 0.5 * q.y * q.z + 0.4 * q.z; };
    HexMesh mesh = with_field(box_mesh(4), "f", value);
    for (Vec3& p : mesh.points) p = bent(p);
    const double voxel = 0.03;
    const LimitCells limit = limit_for_voxels(mesh, {}, voxel);
    EXPECT_TRUE(limit.converged);
    EXPECT_EQ(std::ranges::max(limit.cell_levels), std::max(limit.level, 1));
    double most = 0;
    std::size_t inside = 0;
    for_each_voxel(rasterized(mesh, voxel, limit), [&](const Voxel& v, double stored) {
        const Vec3 x = voxel * Vec3(v[0], v[1], v[2]);
        Vec3 q = x;
        for (int step = 0; step < 40; ++step) q += 0.9 * (x - bent(q));  // a contraction
        ASSERT_LT(glm::length(x - bent(q)), 1e-12);
        most = std::max(most, std::abs(stored - value(q)));
        ++inside;
    });
    EXPECT_GT(inside, 20000u);
    EXPECT_LT(most, 5e-7);
}

// Compared with the trilinear cells of a deep level, which curved cells replace.
TEST(LimitCells, ApproximateADeepLevel) {
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw}) {
        SCOPED_TRACE(static_cast<int>(scheme));
        const HexMesh mesh =
            with_field(ball_mesh(2), "f", [](const Vec3& p) { return std::sin(3 * p.x) * std::cos(2 * p.y) + p.z; });
        constexpr double kVoxel = 0.05, kRange = 4;
        const LimitCellsOptions tolerance{.position_world = 0.1 * kVoxel, .value_of_range = 2e-3};
        const LimitCells limit = find_limit_cells(mesh, {.scheme = {scheme}}, tolerance);
        EXPECT_TRUE(limit.converged);
        EXPECT_LE(limit.position_world, tolerance.position_world);
        EXPECT_LE(limit.value_of_range, tolerance.value_of_range);
        const RasterizeOptions by_cells{.voxel_size_world = kVoxel, .refine = {.scheme = {scheme}}, .limit = &limit};
        const RasterizeOptions deep{.voxel_size_world = kVoxel, .refine = {.scheme = {scheme}, .levels = 4}, .on_limit = true};
        const auto got = values_of(rasterize(mesh, kField, by_cells).front());
        const auto wanted = values_of(rasterize(mesh, kField, deep).front());
        double squares = 0, most = 0;
        std::size_t both = 0;
        for (const auto& [v, value] : wanted) {
            const auto found = got.find(v);
            if (found == got.end()) continue;
            const double error = std::abs(found->second - value);
            most = std::max(most, error);
            squares += error * error;
            ++both;
        }
        // Only centres within the tolerance of the boundary change sides: in a ball, a part of 3·(voxel/radius)·0.1.
        EXPECT_LT(static_cast<double>(wanted.size() - both), 0.02 * static_cast<double>(both));
        EXPECT_LT(static_cast<double>(got.size() - both), 0.02 * static_cast<double>(both));
        // Moved by the tolerance of positions, a centre changes its value by the gradient, which is up to 4.
        EXPECT_LT(most, 4 * tolerance.position_world + 2 * kRange * tolerance.value_of_range);
        EXPECT_LT(std::sqrt(squares / static_cast<double>(both)), 0.5 * kRange * tolerance.value_of_range);
    }
}

TEST(LimitCells, AreFinerWhereTheFieldIsRough) {
    const HexMesh mesh = with_field(box_mesh(8), "f", [](const Vec3& p) { return std::max(0.0, p.x - 0.5) * p.y; });
    const LimitCells limit = find_limit_cells(mesh, {}, {.position_world = 1e-3});
    EXPECT_EQ(limit.level, 0);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const double x = mesh.points[mesh.cells[c][0]].x;
        if (x > 0.7 || x < 0.2) {
            EXPECT_EQ(limit.cell_levels[c], 1) << c;
        }
    }
    EXPECT_GT(std::ranges::max(limit.cell_levels), 1);
}

// Cells of several levels side by side: no centre is lost between them, and none outside the box is active.
TEST(LimitCells, OfSeveralLevelsFitTogether) {
    const HexMesh mesh = with_field(jittered_box_mesh(4), "f", [](const Vec3& p) { return p.x; });
    LimitCells limit{.level = 1, .cell_levels = std::vector<std::uint8_t>(mesh.cells.size())};
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) limit.cell_levels[c] = static_cast<std::uint8_t>(1 + c % 4);
    const VdbGrid grid = rasterized(mesh, 1.0 / 50, limit);
    EXPECT_EQ(grid.report().active_voxels, 50u * 50 * 50);
    for_each_voxel(grid, [&](const Voxel& v, double value) { ASSERT_NEAR(value, v[0] / 50.0, 1e-6); });
}

// Cells that are strongly bent inside a box: some pieces are split into small cells, whose flat faces do not meet the curved
// sides of the pieces beside them. No centre is lost between the two.
TEST(LimitCells, BentPiecesLeaveNoCentreOut) {
    HexMesh mesh = box_mesh(5);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> step(-0.075, 0.075);
    for (Vec3& p : mesh.points) {
        const bool inside = std::min({p.x, p.y, p.z}) > 0.01 && std::max({p.x, p.y, p.z}) < 0.99;
        if (inside) p += test::random_vector(step, random);
    }
    mesh = with_field(std::move(mesh), "f", [](const Vec3& p) { return p.y; });
    for (const int n : {40, 90}) {
        const LimitCells limit = limit_for_voxels(mesh, {}, 1.0 / n);
        const VdbGrid grid = rasterized(mesh, 1.0 / n, limit);
        EXPECT_EQ(grid.report().active_voxels, static_cast<std::size_t>(n) * n * n);
        for_each_voxel(grid, [&](const Voxel& v, double value) { ASSERT_NEAR(value, static_cast<double>(v[1]) / n, 0.1 / n); });
    }
}

// Without levels the cells are used as they are.
TEST(LimitCells, WithoutLevelsAreTheCells) {
    const HexMesh mesh = with_field(jittered_box_mesh(4), "f", [](const Vec3& p) { return p.y * p.y; });
    const LimitCells limit = find_limit_cells(mesh, {}, {.max_levels = 0});
    EXPECT_FALSE(limit.converged);
    EXPECT_TRUE(limit.cell_levels.empty());
    EXPECT_EQ(values_of(rasterized(mesh, 0.04, limit)), values_of(rasterize(mesh, kField, {.voxel_size_world = 0.04}).front()));
}

TEST(LimitCells, SayWhatIsLeftAtTheLastLevel) {
    const HexMesh mesh = with_field(box_mesh(4), "f", [](const Vec3& p) { return std::sin(1e4 * p.x * p.y); });
    double before = HUGE_VAL;
    for (const int levels : {1, 2, 3}) {
        const LimitCells limit = find_limit_cells(mesh, {}, {.position_world = 1e-3, .max_levels = levels});
        EXPECT_FALSE(limit.converged);
        EXPECT_EQ(std::ranges::max(limit.cell_levels), levels);
        EXPECT_GT(limit.value_of_range, 1e-3);
        EXPECT_LT(limit.value_of_range, before / 2);
        before = limit.value_of_range;
    }
}

// Pieces that were not kept are refined again, each cell to the level of its finest piece: the same voxels, and the same values
// within the tolerance, a thousandth of their range of 4. Pieces of a mesh that has moved since do not count.
TEST(LimitCells, AreThoseOfTheMeshWithKeptPiecesOrWithout) {
    const auto field = [](const Vec3& p) { return std::sin(5 * p.x) * p.y + p.z; };
    const HexMesh mesh = with_field(make_model("ball", 4), "f", field);
    const double voxel = bounds(mesh).size().x / 60;
    const LimitCells kept = find_limit_cells(mesh, {}, {.position_world = 0.02 * voxel});
    const LimitCells dropped = find_limit_cells(mesh, {}, {.position_world = 0.02 * voxel, .max_bytes = 1000});
    ASSERT_TRUE(kept.pieces);
    EXPECT_FALSE(dropped.pieces);
    EXPECT_EQ(kept.cell_levels, dropped.cell_levels);
    EXPECT_EQ(kept.piece_count, dropped.piece_count);
    EXPECT_GT(std::ranges::max(kept.cell_levels), 1);
    const auto got = values_of(rasterized(mesh, voxel, kept)), expected = values_of(rasterized(mesh, voxel, dropped));
    std::size_t both = 0;
    for (const auto& [place, value] : got) {
        const auto there = expected.find(place);
        if (there == expected.end()) continue;
        ++both;
        ASSERT_NEAR(value, there->second, 4e-3) << place[0] << " " << place[1] << " " << place[2];
    }
    EXPECT_LE(got.size() + expected.size() - 2 * both, expected.size() / 1000);

    HexMesh moved = mesh;
    for (Vec3& p : moved.points) p += Vec3(3 * voxel, 0, 0);
    EXPECT_EQ(values_of(rasterized(moved, voxel, kept)), values_of(rasterized(moved, voxel, dropped)));
}

// Pieces that are filled as they are found give the voxels of those that are kept, also where cells fold over.
TEST(LimitCells, GiveTheSameVoxelsOnTheWay) {
    const auto field = [](const Vec3& p) { return std::sin(3 * p.x) * p.y + p.z; };
    HexMesh many = with_field(make_model("twist", 42), "f", field), folded = with_field(make_model("ball", 4), "f", field);
    for (std::size_t p = 0; p < folded.points.size(); p += 7) folded.points[p] *= 1.6;
    for (const HexMesh* mesh : {&many, &folded}) {
        const double voxel = bounds(*mesh).size().x / 50;
        const LimitCells kept = limit_for_voxels(*mesh, {}, voxel);
        const LimitGrids found = rasterize_limit(*mesh, kField, {.voxel_size_world = voxel});
        const auto values = values_of(found.grids.front()), expected = values_of(rasterized(*mesh, voxel, kept));
        EXPECT_GT(values.size(), 1000u);
        EXPECT_EQ(found.limit.piece_count, kept.piece_count);
        EXPECT_EQ(finest_level(found.limit), finest_level(kept));
        if (mesh == &many) {
            EXPECT_EQ(values, expected);
            continue;
        }
        // Where cells fold over, the boundary is made of curved sides or of flat parts of them.
        std::size_t both = 0;
        for (const auto& [place, value] : values) {
            const auto there = expected.find(place);
            if (there == expected.end()) continue;
            ++both;
            ASSERT_EQ(value, there->second);
        }
        EXPECT_LE(values.size() + expected.size() - 2 * both, expected.size() / 500);
    }
    EXPECT_THROW((void)rasterize_limit(many, kField, {.resolution = 10, .coverage = true}), Error);
    EXPECT_THROW((void)rasterize_limit(many, kField, {.resolution = 10, .level_set = LevelSetOptions{}}), Error);
}

TEST(LimitCells, OfNothingAreNone) {
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        const LimitCells limit = find_limit_cells({}, {.scheme = {scheme}}, {});
        EXPECT_TRUE(limit.converged);
        EXPECT_TRUE(limit.cell_levels.empty());
    }
}

TEST(LimitCells, OfAnotherMeshAreRefused) {
    const HexMesh mesh = with_field(box_mesh(3), "f", [](const Vec3&) { return 1.0; });
    const LimitCells limit = find_limit_cells(with_field(box_mesh(2), "f", [](const Vec3&) { return 1.0; }), {}, {});
    EXPECT_THROW((void)rasterized(mesh, 0.1, limit), Error);
}

}  // namespace limit_cells_test
}  // namespace subvol
