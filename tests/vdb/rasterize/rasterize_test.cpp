// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numbers>

#include "subvol/error.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace rasterize_test {

using namespace test;

const Field kOne = [](const Vec3&) { return 1.0; };
const Field kLinear = [](const Vec3& p) { return p.x + 2 * p.y + 4 * p.z; };
const Field kWave = [](const Vec3& p) { return std::sin(5 * p.x) * std::cos(4 * p.y) + p.z; };

// Values are stored as floats: half a unit in the last place at 8 is 4.8e-7.
constexpr double kFloatTol = 1e-6;

VdbGrid raster(const HexMesh& mesh, double voxel_size, const std::string& field = "f") {
    const std::vector<std::string> fields{field};
    return std::move(rasterize(mesh, fields, {.voxel_size_world = voxel_size}).front());
}

double volume(const VdbGrid& grid) {
    return static_cast<double>(grid.report().active_voxels) * std::pow(grid.report().voxel_size_world, 3);
}

struct Voxels {
    std::size_t active = 0;
    std::vector<std::optional<double>> values;
};

Voxels voxels_of(const VdbGrid& grid, int n) {
    Voxels voxels;
    for_each_centre(grid.report().voxel_size_world, n, [&](const Vec3& p) {
        voxels.values.push_back(grid.value(p));
        voxels.active += voxels.values.back().has_value();
    });
    return voxels;
}

ErrorCode code_of(const std::function<void()>& call, const std::string& part_of_message = "") {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(part_of_message), std::string::npos) << error.what();
        return error.code();
    }
    ADD_FAILURE() << "no error was thrown";
    return ErrorCode::Io;
}

// Centres on a face belong to one side only (lower in, upper out), so boxes that fit the voxels are filled exactly, whether the
// centres lie on the faces, edges and corners of the cells (first two) or between them.
TEST(Rasterize, BoxHasItsVolume) {
    const auto mesh = with_field(box_mesh(4), "f", kOne);
    EXPECT_EQ(raster(mesh, 1.0 / 16).report().active_voxels, 16u * 16 * 16);
    EXPECT_EQ(raster(mesh, 0.1).report().active_voxels, 1000u);
    const auto between = with_field(box_mesh(4, Vec3(-0.25), Vec3(1.75)), "f", kOne);
    EXPECT_EQ(volume(raster(between, 0.5)), 8.0);
    const auto away = with_field(box_mesh(3, Vec3(-7.3, 0.3, 1000.3), Vec3(-6.3, 1.3, 1001.3)), "f", kOne);
    EXPECT_EQ(raster(away, 0.1).report().active_voxels, 1000u);
    EXPECT_TRUE(raster(mesh, 0.1).value(Vec3(0.0)));
    EXPECT_FALSE(raster(mesh, 0.1).value(Vec3(1.0)));
}

TEST(Rasterize, ResolutionCountsTheLongestSide) {
    const auto mesh = with_field(box_mesh(2, Vec3(0.0), Vec3(2.0, 1.0, 1.0)), "f", kOne);
    const std::vector<std::string> fields{"f"};
    const auto grids = rasterize(mesh, fields, {.resolution = 40});
    EXPECT_DOUBLE_EQ(grids[0].report().voxel_size_world, 0.05);
    EXPECT_EQ(grids[0].report().active_voxels, 40u * 20 * 20);
    const Box& bounds = grids[0].report().bounds;  // of centres: the last ones lie one voxel before the upper faces
    EXPECT_EQ(bounds.lower, Vec3(0.0));
    EXPECT_LT(glm::length(bounds.upper - Vec3(1.95, 0.95, 0.95)), 1e-12);
}

TEST(Rasterize, BallHasItsVolume) {
    // Flat faces of 1/16 of a quarter circle cut 0.4 % off the ball; voxels of 1/100 of it change far less.
    const auto grid = raster(with_field(ball_mesh(16), "f", kOne), 0.02);
    const double ball = 4.0 / 3.0 * std::numbers::pi;
    EXPECT_NEAR(volume(grid), ball, 0.01 * ball);
    EXPECT_LT(volume(grid), ball);
    EXPECT_EQ(grid.report().min, 1.0);
    EXPECT_EQ(grid.report().max, 1.0);
}

TEST(Rasterize, NoHolesBetweenBentCells) {
    const double h = 0.0173;
    const int n = 60;
    const auto grid = raster(with_field(jittered_box_mesh(6), "f", kLinear), h);
    std::size_t inside = 0;
    for_each_centre(h, n, [&](const Vec3& p) {
        const bool expected = glm::all(glm::greaterThanEqual(p, Vec3(0.0))) && glm::all(glm::lessThan(p, Vec3(1.0)));
        const auto value = grid.value(p);
        ASSERT_EQ(value.has_value(), expected) << p.x << ' ' << p.y << ' ' << p.z;
        inside += expected;
        if (expected) {
            ASSERT_NEAR(*value, kLinear(p), kFloatTol);
        }
    });
    EXPECT_EQ(grid.report().active_voxels, inside);
}

TEST(Rasterize, LinearFieldOnBall) {
    const auto grid = raster(with_field(ball_mesh(5), "f", kLinear), 0.05);
    std::size_t active = 0;
    for_each_centre(0.05, 21, [&](const Vec3& p) {
        if (const auto value = grid.value(p)) {
            ++active;
            ASSERT_NEAR(*value, kLinear(p), kFloatTol);
        }
    });
    EXPECT_EQ(active, grid.report().active_voxels);
}

// x = u, y = v (1 + u/2), z = w (1 + u v/2) is trilinear, and can be solved by hand: the field u v w is not linear in x, so
// the values show that the trilinear map is inverted.
TEST(Rasterize, InvertsTheTrilinearMap) {
    HexMesh mesh = with_field(box_mesh(1), "f", [](const Vec3& p) { return p.x * p.y * p.z; });
    for (Vec3& p : mesh.points) p = {p.x, p.y * (1 + p.x / 2), p.z * (1 + p.x * p.y / 2)};
    const auto grid = raster(mesh, 0.05);
    std::size_t compared = 0;
    for_each_centre(0.05, 40, [&](const Vec3& p) {
        const auto value = grid.value(p);
        const double u = p.x, v = p.y / (1 + u / 2), w = p.z / (1 + u * v / 2);
        if (!value || std::max({u, v, w}) > 1) return;
        ++compared;
        ASSERT_NEAR(*value, u * v * w, kFloatTol);
    });
    EXPECT_GT(compared, 9000u);  // the cell's volume is 1.4, a voxel's 1.25e-4
}

TEST(Rasterize, ZeroInsideIsActive) {
    const auto grid = raster(with_field(box_mesh(1), "f", [](const Vec3&) { return 0.0; }), 0.25);
    EXPECT_EQ(grid.report().active_voxels, 64u);
    EXPECT_EQ(grid.value(Vec3(0.5)), 0.0);
}

TEST(Rasterize, FieldsShareTheirVoxels) {
    auto mesh = with_field(jittered_box_mesh(3), "f", kLinear);
    add_field(mesh, "g", kWave);
    const std::vector<std::string> fields{"g", "f"};
    const auto grids = rasterize(mesh, fields, {.voxel_size_world = 0.05});
    ASSERT_EQ(grids.size(), 2u);
    EXPECT_EQ(grids[0].report().name, "g");
    EXPECT_EQ(grids[1].report().name, "f");
    EXPECT_EQ(grids[0].report().active_voxels, grids[1].report().active_voxels);
    EXPECT_EQ(voxels_of(grids[1], 20).values, voxels_of(raster(mesh, 0.05), 20).values);
}

TEST(Rasterize, SameForAnyNumberOfThreads) {
    const auto mesh = with_field(jittered_box_mesh(5), "f", kWave);
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return voxels_of(raster(mesh, 0.021), 50);
    };
    const auto one = run(1), two = run(2);
    EXPECT_GT(one.active, 100000u);
    EXPECT_TRUE(one.values == two.values);  // exact: values are floats widened to doubles
}

TEST(Rasterize, OrderOfCellsDoesNotMatter) {
    auto mesh = with_field(jittered_box_mesh(5), "f", kWave);
    const auto forward = voxels_of(raster(mesh, 0.021), 50);
    std::reverse(mesh.cells.begin(), mesh.cells.end());
    const auto backward = voxels_of(raster(mesh, 0.021), 50);
    EXPECT_EQ(forward.active, backward.active);
    for (std::size_t i = 0; i < forward.values.size(); ++i) {
        ASSERT_EQ(forward.values[i].has_value(), backward.values[i].has_value());
        if (forward.values[i]) {
            ASSERT_NEAR(*forward.values[i], *backward.values[i], kFloatTol);
        }
    }
}

TEST(Rasterize, CellsThatAreNotProper) {
    const auto proper = with_field(box_mesh(2), "f", kLinear);
    auto mirrored = proper;
    for (auto& cell : mirrored.cells) std::swap_ranges(cell.begin(), cell.begin() + 4, cell.begin() + 4);
    EXPECT_EQ(voxels_of(raster(mirrored, 0.1), 12).active, 1000u);

    auto flat = proper;  // the cells above become flat
    for (Vec3& p : flat.points) p.z = std::min(p.z, 0.5);
    EXPECT_EQ(raster(flat, 0.1).report().active_voxels, 500u);

    auto collapsed = proper;
    for (const Index p : collapsed.cells[0]) collapsed.points[p] = Vec3(0.5);
    EXPECT_LT(raster(collapsed, 0.1).report().active_voxels, 1000u);

    auto folded = with_field(box_mesh(1), "f", kLinear);
    std::swap(folded.points[0], folded.points[7]);
    const auto grid = raster(folded, 0.05);
    EXPECT_GE(grid.report().min, 0.0);
    EXPECT_LE(grid.report().max, 7.0);
}

TEST(Rasterize, VoxelsLargerThanTheMesh) {
    const auto mesh = with_field(box_mesh(3, Vec3(0.1), Vec3(0.2)), "f", kOne);
    const auto grid = raster(mesh, 1.0);
    EXPECT_EQ(grid.report().active_voxels, 0u);
    EXPECT_TRUE(grid.report().bounds.empty());
    EXPECT_FALSE(grid.value(Vec3(0.15)));
}

TEST(Rasterize, RefusesWhatCannotBe) {
    auto mesh = with_field(box_mesh(1), "f", kOne);
    mesh.attributes.push_back({"v", 2, std::vector<double>(16)});
    const std::vector<std::string> f{"f"}, none, missing{"g"}, vector{"v"};
    const auto invalid = [&](const std::vector<std::string>& fields, const RasterizeOptions& options, const std::string& says) {
        EXPECT_EQ(code_of([&] { (void)rasterize(mesh, fields, options); }, says), ErrorCode::InvalidInput);
    };
    invalid(none, {}, "no field");
    invalid(missing, {}, "\"g\"");
    invalid(vector, {}, "2 channels");
    invalid(f, {.voxel_size_world = -1}, "not positive");
    invalid(f, {.voxel_size_world = std::nan("")}, "not positive");
    invalid(f, {.resolution = 0}, "below one");
    invalid(f, {.voxel_size_world = 1e-5}, "at least 0.0008");  // 2e9 voxels in a unit box
    invalid(f, {.voxel_size_world = 1e-10}, "32 bits");
    mesh.attributes[0].values[3] = 1e5;
    invalid(f, {.resolution = 4, .half = true}, "16-bit");
    for (auto& p : mesh.points) p *= 1e-6;
    // OpenVDB itself would throw a foreign exception.
    invalid(f, {.resolution = 4}, "at least 1.45e-5: --scale 1e6 makes the mesh larger");
}

TEST(Rasterize, VoxelsAreCheckedWithoutMakingAny) {
    const auto mesh = with_field(box_mesh(1), "f", kOne);
    const auto refused = [&](const RasterizeOptions& options, const std::string& says) {
        EXPECT_EQ(code_of([&] { check_voxels(mesh, options); }, says), ErrorCode::InvalidInput);
    };
    EXPECT_NO_THROW(check_voxels(mesh, {.resolution = 20}));
    refused({.voxel_size_world = std::nan("")}, "not positive");
    refused({.voxel_size_world = 1e-5}, "at least 0.0008");
    refused({.voxel_size_world = 1e-10}, "32 bits");
    refused({.resolution = 1 << 20}, "2e9 voxels");
    refused({.resolution = 10, .level_set = LevelSetOptions{.half_width_voxels = std::nan("")}}, "half width");
    auto huge = mesh;
    for (auto& p : huge.points) p *= 1e200;
    EXPECT_EQ(code_of([&] { check_voxels(huge, {.voxel_size_world = 1e195}); }, "a mesh whose volume is a finite number"),
              ErrorCode::InvalidInput);
}

class Impatient : public Progress {
public:
    void report(std::string_view, double fraction) override { last_ = fraction; }
    [[nodiscard]] bool cancelled() const override { return last_ > 0; }

private:
    double last_ = 0;
};

TEST(Rasterize, CanBeStopped) {
    const auto mesh = with_field(box_mesh(2), "f", kOne);
    const std::vector<std::string> fields{"f"};
    Impatient progress;
    EXPECT_EQ(code_of([&] { (void)rasterize(mesh, fields, {.progress = &progress}); }), ErrorCode::Cancelled);
}

}  // namespace rasterize_test
}  // namespace subvol
