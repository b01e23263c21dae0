// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/rasterize.h"
#include "subvol/surface.h"
#include "subvol/vdb_grid.h"
#include "vdb/each_voxel.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace level_set_test {

using namespace test;

const std::vector<std::string> kField{"f"};
const Field kOne = [](const Vec3&) { return 1.0; };

/// The volume itself, and its level set.
std::vector<VdbGrid> volume_and_level_set(const HexMesh& mesh, RasterizeOptions options, double half_width = 3) {
    options.level_set = LevelSetOptions{.half_width_voxels = half_width};
    const std::vector<std::string> first{mesh.attributes.front().name};
    return rasterize(mesh, first, options);
}

/// The distance from a triangle: from its plane if the perpendicular meets the triangle, else from the nearest of its edges.
double distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto to_edge = [&](const Vec3& from, const Vec3& to) {
        const Vec3 along = to - from;
        const double t = std::clamp(glm::dot(p - from, along) / glm::dot(along, along), 0.0, 1.0);
        return glm::length(p - from - t * along);
    };
    double least = std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
    const Vec3 normal = glm::cross(b - a, c - a);
    const auto left_of = [&](const Vec3& from, const Vec3& to) {
        return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
    };
    if (left_of(a, b) && left_of(b, c) && left_of(c, a)) {
        least = std::min(least, std::abs(glm::dot(p - a, normal)) / glm::length(normal));
    }
    return least;
}

/// Checks every voxel of the level set's box: the sign is that of the volume; beyond the band the value is the background.
void expect_signs_of_the_volume(const std::vector<VdbGrid>& grids, double half_width) {
    const auto volume = grids.front().voxels(), level_set = grids.back().voxels();
    const auto inside = volume->cursor(), distances = level_set->cursor();
    const float background = static_cast<float>(half_width * grids.back().report().voxel_size_world);
    const auto [lower, upper] = level_set->range();
    std::size_t band = 0, within = 0, beyond = 0;
    for (int x = lower[0] - 9; x <= upper[0] + 9; ++x) {
        for (int y = lower[1] - 9; y <= upper[1] + 9; ++y) {
            for (int z = lower[2] - 9; z <= upper[2] + 9; ++z) {
                const bool is_inside = inside->corners({x, y, z}).active & 1;
                const VoxelCorners at = distances->corners({x, y, z});
                ASSERT_EQ(std::signbit(at.values[0]), is_inside) << x << ' ' << y << ' ' << z;
                if (at.active & 1) {
                    ++band;
                    ASSERT_LE(std::abs(at.values[0]), static_cast<double>(background));  // equal where a float rounds up
                } else {
                    ++(is_inside ? within : beyond);
                    ASSERT_EQ(std::abs(at.values[0]), static_cast<double>(background));
                }
            }
        }
    }
    EXPECT_GT(band, 1000u);
    EXPECT_GT(beyond, 1000u);
    ::testing::Test::RecordProperty("band", static_cast<int>(band));
    ::testing::Test::RecordProperty("within", static_cast<int>(within));
}

// The mesh's boundary lies between the unit sphere and the sphere that its nearest triangle touches: the distances from two
// surfaces differ at most by the distance of the surfaces.
TEST(LevelSet, OfABallIsTheDistanceFromItsSphere) {
    const HexMesh mesh = with_field(ball_mesh(16), "f", kOne);
    const Surface surface = boundary_surface(mesh);
    double nearest = 1;
    for (const auto& [a, b, c] : surface.triangles) {
        const Vec3 &p = surface.points[a], &q = surface.points[b], &r = surface.points[c];
        nearest = std::min(nearest, glm::dot(p, glm::normalize(glm::cross(q - p, r - p))));
    }
    const double bound = 1 - nearest + 1e-7;  // rounding of a float at 0.2
    EXPECT_LT(bound, 0.01);
    constexpr double kSize = 0.04;
    const auto grids = volume_and_level_set(mesh, {.voxel_size_world = kSize}, 5);
    std::size_t active = 0;
    for_each_voxel(grids.back(), [&](const Voxel& v, double value) {
        ++active;
        ASSERT_NEAR(value, kSize * glm::length(Vec3(v[0], v[1], v[2])) - 1, bound);
    });
    const double shell = 4.0 / 3.0 * kPi * (std::pow(1.2, 3) - std::pow(0.8, 3)) / std::pow(kSize, 3);
    EXPECT_NEAR(static_cast<double>(active), shell, 0.02 * shell);  // the band is whole
    expect_signs_of_the_volume(grids, 5);
}

// Compared with a loop over all triangles, at every centre near the boundary.
TEST(LevelSet, IsTheDistanceFromTheNearestTriangle) {
    const HexMesh mesh = with_field(jittered_box_mesh(3), "f", kOne);
    HexMesh bent = mesh;
    for (Vec3& p : bent.points) p += 0.2 * Vec3(std::sin(3 * p.y), std::sin(4 * p.z), std::sin(5 * p.x));
    const Surface surface = boundary_surface(bent);
    constexpr double kSize = 0.06;
    const auto grids = volume_and_level_set(bent, {.voxel_size_world = kSize}, 2.5);
    const auto level_set = grids.back().voxels();
    const auto cursor = level_set->cursor();
    std::size_t active = 0;
    for_each_centre(kSize, 25, [&](const Vec3& p) {
        double nearest = HUGE_VAL;
        for (const auto& [a, b, c] : surface.triangles) {
            nearest = std::min(nearest, distance(p, surface.points[a], surface.points[b], surface.points[c]));
        }
        const auto voxel = [&](double x) { return static_cast<int>(std::round(x / kSize)); };
        const VoxelCorners at = cursor->corners({voxel(p.x), voxel(p.y), voxel(p.z)});
        // Inside and farther away voxels are inactive, and have the background below zero.
        const bool in_band = (at.active & 1) != 0 && at.values[0] > -grids.back().report().outside;
        active += in_band ? 1 : 0;
        ASSERT_EQ(in_band, nearest < 2.5 * kSize);
        if (in_band) {
            ASSERT_NEAR(std::abs(at.values[0]), nearest, 2e-8);  // half a unit in the last place of a float at 0.15 is 7e-9
        }
    });
    EXPECT_EQ(active, grids.back().report().active_voxels);
    EXPECT_EQ(grids.back().report().name, "sdf");
    expect_signs_of_the_volume(grids, 2.5);
}

// A third of a voxel thick and oblique: few centres lie inside, and none of their neighbours do.
TEST(LevelSet, SignsAreRightOnAPlateThinnerThanAVoxel) {
    HexMesh plate = with_field(box_mesh(5, Vec3(-1.0), Vec3(1.0)), "f", kOne);
    constexpr double kSize = 0.05;
    for (Vec3& p : plate.points) {
        p.z *= kSize / 6;
        const double s = std::sin(0.3), c = std::cos(0.3);
        p = {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
        p = {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
    }
    const auto grids = volume_and_level_set(plate, {.voxel_size_world = kSize});
    EXPECT_GT(grids.front().report().active_voxels, 200u);
    EXPECT_NEAR(grids.back().report().min, -kSize / 6, 1e-3 * kSize);  // no deeper than half the plate
    expect_signs_of_the_volume(grids, 3);
}

TEST(LevelSet, SignsAreRightOnModelsThatAreNotConvex) {
    for (const char* model : {"alien", "fan"}) {
        SCOPED_TRACE(model);
        expect_signs_of_the_volume(volume_and_level_set(make_model(model), {.resolution = 80, .refine = {.levels = 1}}), 3);
    }
    expect_signs_of_the_volume(
        volume_and_level_set(with_field(jittered_box_mesh(3), "f", kOne),
                             {.resolution = 30, .refine = {.scheme = {Scheme::CatmullClark}, .levels = 1}, .on_limit = true}),
        3);
}

std::vector<std::pair<Voxel, double>> list(const VdbGrid& grid) {
    std::vector<std::pair<Voxel, double>> all;
    for_each_voxel(grid, [&](const Voxel& v, double value) { all.emplace_back(v, value); });
    return all;
}

TEST(LevelSet, SameForAnyNumberOfThreadsAndInParts) {
    const HexMesh mesh = with_field(ball_mesh(6), "f", kOne);
    const RasterizeOptions options{.resolution = 150, .level_set = LevelSetOptions{.name = "surface"}};
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return list(rasterize(mesh, kField, options).back());
    };
    const auto whole = run(1);
    EXPECT_TRUE(whole == run(2));
    std::vector<std::pair<Voxel, double>> parts;
    int count = 0;
    rasterize_parts(mesh, kField, options, 1 << 20, [&](const GridPart& part) {
        ++count;
        const auto some = list(part.grids.back());
        parts.insert(parts.end(), some.begin(), some.end());
    });
    EXPECT_GT(count, 1);
    EXPECT_TRUE(parts == whole);  // slabs follow each other in x
}

TEST(LevelSet, RefusesWhatCannotBe) {
    const HexMesh mesh = with_field(box_mesh(1), "f", kOne);
    for (const double half_width : {0.5, 2000.0, std::nan("")}) {
        EXPECT_THROW((void)volume_and_level_set(mesh, {.resolution = 4}, half_width), Error);
    }
    HexMesh sheet = mesh;  // little volume, and a surface of 10¹⁰ voxels
    for (Vec3& p : sheet.points) p = {p.x, p.y, 1e-5 + 1e-9 * p.z};
    EXPECT_THROW((void)volume_and_level_set(sheet, {.voxel_size_world = 2e-5}), Error);
}

}  // namespace level_set_test
}  // namespace subvol
