// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include "openvdb_grids.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"
#include "vdb/each_voxel.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace grids_test {

using namespace test;

const std::vector<std::string> kField{"f"};
const Field kWave = [](const Vec3& p) { return std::sin(5 * p.x) * std::cos(4 * p.y) + p.z; };

std::vector<std::pair<Voxel, double>> list(const VdbGrid& grid) {
    std::vector<std::pair<Voxel, double>> all;
    for_each_voxel(grid, [&](const Voxel& v, double value) { all.emplace_back(v, value); });
    return all;
}

// A refined mesh and its streamed refinement cut bent cells differently, by some 1e-3 of a cell here; the box around them is
// flat.
TEST(VdbRefined, StreamedFitsTheWholeMesh) {
    const auto mesh = with_field(jittered_box_mesh(4), "f", kWave);
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        const RefineOptions refinement{.scheme = {scheme}, .levels = 2};
        const auto whole = rasterize(refine(mesh, refinement), kField, {.voxel_size_world = 0.021});
        const auto streamed = rasterize(mesh, kField, {.voxel_size_world = 0.021, .refine = refinement});
        const GridDifference difference = compare_voxels(whole.front(), streamed.front());
        EXPECT_EQ(whole.front().report().active_voxels, streamed.front().report().active_voxels);
        EXPECT_EQ(difference.voxels, streamed.front().report().active_voxels);
        EXPECT_LT(difference.max, 2e-2);
        EXPECT_LT(difference.rms, 2e-4);
    }
}

TEST(VdbGrids, VoxelsOfOtherPlacesAreNotCompared) {
    const auto box = with_field(jittered_box_mesh(2), "f", kWave);
    HexMesh far = box;
    for (Vec3& p : far.points) p += Vec3(100);
    const auto grid_of = [&](const HexMesh& mesh, double h) {
        return std::move(rasterize(mesh, kField, {.voxel_size_world = h}).front());
    };
    const VdbGrid grid = grid_of(box, 0.25);
    const GridDifference nothing = compare_voxels(grid, grid_of(far, 0.25));
    EXPECT_EQ(nothing.voxels, 0u);
    EXPECT_TRUE(std::isnan(nothing.rms) && std::isnan(nothing.max));
    EXPECT_THROW((void)compare_voxels(grid, grid_of(box, 0.125)), Error);  // an index is another place
}

TEST(VdbRefined, SameForAnyNumberOfThreads) {
    const auto mesh = make_model("ball", 5);
    const std::vector<std::string> density{"density"};
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return list(rasterize(mesh, density, {.resolution = 70, .refine = {.levels = 2}}).front());
    };
    EXPECT_TRUE(run(1) == run(2));  // exact: values are floats widened to doubles
}

TEST(VdbGrids, PartsAreThePiecesOfTheWhole) {
    const auto mesh = make_model("pawn");
    const std::vector<std::string> density{"density"};
    for (const int levels : {0, 1}) {
        const RasterizeOptions options{.resolution = 160, .refine = {.levels = levels}, .coverage = true};
        const auto whole = rasterize(mesh, density, options);
        std::array<std::vector<std::pair<Voxel, double>>, 2> parts;
        int count = 0;
        rasterize_parts(mesh, density, options, 1 << 20, [&](const GridPart& part) {
            EXPECT_EQ(part.number, count++);
            EXPECT_GT(part.of, 1);
            for (std::size_t g = 0; g < 2; ++g) {
                const auto some = list(part.grids[g]);
                parts[g].insert(parts[g].end(), some.begin(), some.end());
            }
        });
        for (std::size_t g = 0; g < 2; ++g) EXPECT_TRUE(parts[g] == list(whole[g]));  // slabs follow each other in x
    }
}

TEST(VdbGrids, ThreeChannelsBecomeVectors) {
    auto mesh = with_field(jittered_box_mesh(3), "f", kWave);
    Attribute vector{"v", 3, {}};
    for (const Vec3& p : mesh.points) vector.values.insert(vector.values.end(), {kWave(p), p.x + 2 * p.y, -p.z});
    mesh.attributes.push_back(vector);
    const std::vector<std::string> fields{"v", "f"};
    const auto grids = rasterize(mesh, fields, {.voxel_size_world = 0.03});
    EXPECT_EQ(grids[0].report().kind, "vector");
    EXPECT_FALSE(grids[0].value(Vec3(0.5)));
    const auto path = std::filesystem::path(::testing::TempDir()) / "vectors.vdb";
    write_vdb(path, grids);
    openvdb::io::File file(path.string());
    file.open();
    const auto vectors = openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid("v"));
    const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("f"));
    ASSERT_TRUE(vectors && floats);
    EXPECT_EQ(vectors->activeVoxelCount(), floats->activeVoxelCount());
    for (auto at = vectors->cbeginValueOn(); at; ++at) {
        const auto x = vectors->indexToWorld(at.getCoord());
        ASSERT_EQ((*at)[0], floats->tree().getValue(at.getCoord()));
        ASSERT_NEAR((*at)[1], x[0] + 2 * x[1], 1e-6);
        ASSERT_NEAR((*at)[2], -x[2], 1e-6);
    }
    std::filesystem::remove(path);
}

TEST(VdbGrids, CellNumbersAndMask) {
    const auto mesh = with_field(box_mesh(4), "f", kWave);
    const auto grids = rasterize(mesh, kField, {.voxel_size_world = 1.0 / 32, .cell_numbers = true, .mask = true});
    ASSERT_EQ(grids.size(), 3u);
    EXPECT_EQ(grids[1].report().name, "cell");
    EXPECT_EQ(grids[1].report().max, 63);
    EXPECT_EQ(grids[2].report().name, "mask");
    const auto path = std::filesystem::path(::testing::TempDir()) / "cells.vdb";
    write_vdb(path, grids, VdbCompression::Zip);
    openvdb::io::File file(path.string());
    file.open();
    const auto cells = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("cell"));
    ASSERT_TRUE(cells);
    EXPECT_EQ(file.readGrid("mask")->activeVoxelCount(), 32u * 32 * 32);
    EXPECT_EQ(cells->activeVoxelCount(), 32u * 32 * 32);
    EXPECT_EQ(cells->constTree().leafCount(), 0u);  // each cell fills a leaf, which becomes a tile
    for (int i = 0; i < 32; ++i) {
        for (int j = 0; j < 32; ++j) {
            for (int k = 0; k < 32; ++k) ASSERT_EQ(cells->tree().getValue({i, j, k}), i / 8 + 4 * (j / 8) + 16 * (k / 8));
        }
    }
    std::filesystem::remove(path);
}

// The coverage of a box whose faces lie on quarters of voxels is exact; a ball's coverage adds up to its volume with the error
// of voxels a quarter as large.
TEST(VdbGrids, CoverageIsThePartThatIsFilled) {
    const auto box = with_field(box_mesh(2, Vec3(0.0), Vec3(1.0, 1.0, 1.025)), "f", kWave);
    const auto grids = rasterize(box, kField, {.voxel_size_world = 0.1, .coverage = true});
    EXPECT_EQ(grids[1].report().name, "coverage");
    double sum = 0;
    for_each_voxel(grids[1], [&](const Voxel&, double part) { sum += part; });
    EXPECT_NEAR(sum * 1e-3, 1.025, 1e-9);
    EXPECT_FLOAT_EQ(static_cast<float>(*grids[1].value(Vec3(0.0, 0.5, 0.5))), 0.5f);  // its centre lies on the face

    const auto ball = with_field(ball_mesh(8), "f", kWave);
    const auto of_ball = rasterize(ball, kField, {.voxel_size_world = 0.1, .coverage = true});
    const auto fine = rasterize(ball, kField, {.voxel_size_world = 0.0125});
    const double volume = static_cast<double>(fine.front().report().active_voxels) * std::pow(0.0125, 3);
    double covered = 0;
    for_each_voxel(of_ball[1], [&](const Voxel&, double part) { covered += part; });
    EXPECT_NEAR(covered * 1e-3, volume, 2e-3 * volume);
}

TEST(VdbGrids, LikeAnotherGrid) {
    const auto mesh = with_field(jittered_box_mesh(3), "f", [](const Vec3& p) { return p.x - p.y + 2 * p.z; });
    auto placed = openvdb::FloatGrid::create();
    auto transform = openvdb::math::Transform::createLinearTransform(0.04);
    transform->postRotate(0.3, openvdb::math::Z_AXIS);
    transform->postTranslate({0.013, -0.4, 0.007});
    placed->setTransform(transform);
    placed->tree().setValue({0, 0, 0}, 1.0f);
    const auto path = std::filesystem::path(::testing::TempDir()) / "like.vdb";
    openvdb::io::File(path.string()).write({placed});
    const auto like = read_vdb(path);
    const auto grids = rasterize(mesh, kField, {.like = &like.front()});
    EXPECT_NEAR(static_cast<double>(grids.front().report().active_voxels) * std::pow(0.04, 3), 1.0, 0.01);
    write_vdb(path, grids);
    openvdb::io::File file(path.string());
    file.open();
    const auto read = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("f"));
    EXPECT_EQ(read->transform(), *transform);
    for (auto at = read->cbeginValueOn(); at; ++at) {
        const auto x = transform->indexToWorld(at.getCoord());
        ASSERT_NEAR(*at, x[0] - x[1] + 2 * x[2], 1e-6);
    }
    std::filesystem::remove(path);
}

TEST(VdbGrids, ConstantFieldsBecomeTiles) {
    const auto mesh = with_field(box_mesh(3), "f", [](const Vec3&) { return 0.5; });
    const auto constant = std::move(rasterize(mesh, kField, {.voxel_size_world = 1.0 / 64}).front());
    const auto varied = rasterize(with_field(box_mesh(3), "f", kWave), kField, {.voxel_size_world = 1.0 / 64});
    EXPECT_EQ(constant.report().active_voxels, 64u * 64 * 64);
    EXPECT_LT(constant.report().bytes, varied.front().report().bytes / 4);  // mostly inner nodes
    EXPECT_EQ(constant.value(Vec3(0.4)), 0.5);
}

}  // namespace grids_test
}  // namespace subvol
