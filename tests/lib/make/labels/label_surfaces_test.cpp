// SPDX-License-Identifier: Apache-2.0
#include "subvol/control_mesh.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "lib/temp_folder.h"

namespace subvol {
namespace labels_test {

using test::error_of;

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

/// Voxels (0, 0, 0) to size − 1, with labels by the places of their centres in voxels.
LabelGrid grid_of(const std::array<std::size_t, 3>& size, const std::function<int(const Vec3&)>& label,
                  const Mat3& to_world = Mat3(1), const Vec3& origin = Vec3(0.0)) {
    LabelGrid grid(to_world, origin);
    LabelRows rows(grid, size);
    std::vector<std::int64_t> row(size[0]);
    for (std::size_t k = 0; k < size[2]; ++k) {
        for (std::size_t j = 0; j < size[1]; ++j) {
            for (std::size_t i = 0; i < size[0]; ++i)
                row[i] = label({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
            rows.take(row);
        }
    }
    rows.finish();
    return grid;
}

/// How often each edge is there in one direction more than in the other, and how many triangles it has at most.
void expect_closed(const Surface& surface) {
    std::map<std::pair<Index, Index>, int> sums;
    for (const auto& t : surface.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Index a = t[k], b = t[(k + 1) % 3];
            sums[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    }
    for (const auto& [edge, sum] : sums) ASSERT_EQ(sum, 0);
}

double rms_of(const Surface& surface, const std::function<double(const Vec3&)>& distance) {
    double sum = 0;
    std::size_t count = 0;
    for (const Vec3& x : surface.points) {
        const double d = distance(x);
        if (std::isnan(d)) continue;
        sum += d * d;
        ++count;
    }
    return std::sqrt(sum / static_cast<double>(count));
}

TEST(Labels, TheHalvesOfABallShareTheirWall) {
    const Vec3 middle(31.63, 31.79, 32.13), normal = glm::normalize(Vec3(1, 0.3, 0));
    constexpr double kRadius = 25.6;
    const LabelGrid grid = grid_of({64, 64, 64}, [&](const Vec3& x) {
        return glm::length(x - middle) > kRadius ? 0 : glm::dot(x - middle, normal) > 0 ? 1 : 2;
    });
    const LabelSurfaces made = label_surfaces(grid);
    ASSERT_EQ(made.materials.size(), 2U);
    EXPECT_EQ(made.materials[0].name, "label_1");
    std::set<std::array<double, 3>> first;
    std::size_t shared = 0;
    for (const MaterialSurface& material : made.materials) {
        expect_closed(material.surface);
        const double half = 2 * kPi / 3 * std::pow(kRadius, 3);
        EXPECT_NEAR(enclosed_volume(material.surface) / half, 1, 2e-3);  // as many voxels are in it
        const auto from_ball = [&](const Vec3& x) {
            return std::abs(glm::dot(x - middle, normal)) > 2 ? glm::length(x - middle) - kRadius : NAN;
        };
        const auto from_wall = [&](const Vec3& x) {
            return glm::length(x - middle) < kRadius - 2 ? glm::dot(x - middle, normal) : NAN;
        };
        EXPECT_LT(rms_of(material.surface, from_ball), 0.08);
        EXPECT_LT(rms_of(material.surface, from_wall), 0.1);
        for (const Vec3& x : material.surface.points) {
            if (&material == &made.materials[0]) {
                first.insert({x.x, x.y, x.z});
            } else {
                shared += first.contains({x.x, x.y, x.z}) ? 1 : 0;
            }
        }
    }
    EXPECT_GT(static_cast<double>(shared), kPi * kRadius * kRadius);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(label_surfaces(grid).materials[1].surface.points, made.materials[1].surface.points);
}

TEST(Labels, BoxesKeepTheirEdgesInAnyFrame) {
    // Two boxes side by side, in voxels that are not cubes, mirrored and turned: exact, whatever the smoothing.
    const Mat3 turned(Vec3(0, 2, 0), Vec3(0, 0, 0.5), Vec3(3, 0, 0)), mirrored(Vec3(0, 0, 0.5), Vec3(0, 2, 0), Vec3(3, 0, 0));
    for (const Mat3& frame : {turned, mirrored}) {
        const Vec3 origin(10, -20, 30);
        const LabelGrid grid = grid_of(
            {20, 16, 12}, [](const Vec3& x) { return x.x < 8 ? 5 : 7; }, frame, origin);
        const LabelSurfaces made = label_surfaces(grid, {.labels = {"7=right", "5=left"}});
        ASSERT_EQ(made.materials.size(), 2U);
        EXPECT_EQ(made.materials[0].name, "right");
        EXPECT_NEAR(enclosed_volume(made.materials[0].surface), 12 * 16 * 12 * 3.0, 1e-6);
        EXPECT_NEAR(enclosed_volume(made.materials[1].surface), 8 * 16 * 12 * 3.0, 1e-6);
        EXPECT_EQ(made.report[1].voxels, 8U * 16U * 12U);
        const Box box = bounds(made.materials[1].surface);
        const Vec3 low = frame * Vec3(-0.5) + origin, high = frame * Vec3(7.5, 15.5, 11.5) + origin;
        EXPECT_LT(glm::distance(box.lower, glm::min(low, high)), 1e-9);
        EXPECT_LT(glm::distance(box.upper, glm::max(low, high)), 1e-9);
    }
}

TEST(Labels, ABallWithinABallHasTheVolumesOfItsVoxels) {
    const Vec3 middle(20.3, 19.8, 20.1);
    const LabelGrid grid = grid_of({41, 41, 41}, [&](const Vec3& x) {
        const double r = glm::length(x - middle);
        return r < 7 ? 2 : r < 16 ? 1 : 0;
    });
    const LabelSurfaces made = label_surfaces(grid);
    const double inner = 4 * kPi / 3 * std::pow(7, 3), outer = 4 * kPi / 3 * std::pow(16, 3);
    EXPECT_NEAR(enclosed_volume(made.materials[0].surface) / (outer - inner), 1, 5e-3);
    EXPECT_NEAR(enclosed_volume(made.materials[1].surface) / inner, 1, 1e-2);
    for (const LabelReport& label : made.report) EXPECT_NEAR(label.enclosed_world / label.voxels_world, 1, 1e-4);
    EXPECT_LT(rms_of(made.materials[1].surface, [&](const Vec3& x) { return glm::length(x - middle) - 7; }), 0.12);
    // Alone, the core is outside of what is around it.
    const LabelSurfaces shell = label_surfaces(grid, {.labels = {"1"}});
    ASSERT_EQ(shell.materials.size(), 1U);
    EXPECT_NEAR(enclosed_volume(shell.materials[0].surface) / (outer - inner), 1, 5e-3);
}

TEST(Labels, BlocksOfOneLabelAndPlacesBelowZeroAreVoxelsToo) {
    // A box of whole blocks far from the origin, one of its blocks of voxels; a voxel that touches it in an edge.
    LabelGrid grid;
    for (int x = -2; x < 1; ++x) {
        for (int y = -2; y < 0; ++y) grid.set({x, y, -1}, 3);
    }
    LabelGrid::Voxels voxels;
    voxels.fill(3);
    grid.set({0, -1, -1}, voxels);
    EXPECT_EQ(grid.blocks().size(), 6U);
    const LabelSurfaces made = label_surfaces(grid);
    EXPECT_EQ(made.report[0].voxels, 6U * 512U);
    EXPECT_NEAR(enclosed_volume(made.materials[0].surface), 24 * 16 * 8, 1e-9);
    const Box box = bounds(made.materials[0].surface);
    EXPECT_EQ(box.lower, Vec3(-16.5, -16.5, -8.5));
    EXPECT_EQ(box.upper, Vec3(7.5, -0.5, -0.5));
    // Two voxels that touch in an edge: closed, with the volume of both.
    const LabelGrid two = grid_of({2, 2, 1}, [](const Vec3& x) { return x.x == x.y ? 1 : 0; });
    const LabelSurfaces touching = label_surfaces(two, {.smooth = 0});
    expect_closed(touching.materials[0].surface);
    EXPECT_NEAR(enclosed_volume(touching.materials[0].surface), 2, 1e-12);
}

TEST(Labels, WhatIsNotThereIsRefused) {
    const LabelGrid grid = grid_of({4, 4, 4}, [](const Vec3& x) { return x.x < 2 ? 1 : 2; });
    const auto error = [&](const LabelOptions& options) { return error_of([&] { (void)label_surfaces(grid, options); }); };
    EXPECT_THAT(error({.labels = {"3"}}), HasSubstr("label: no voxel has the label 3 (labels: 1, 2)"));
    EXPECT_THAT(error({.labels = {"1", "1=b"}}), HasSubstr("label 1 is there twice"));
    EXPECT_THAT(error({.labels = {"1=b", "2=b"}}), HasSubstr("two labels have the name"));
    for (const char* wrong : {"", "0", "-1", "1=", "bone", "1.5", "99999999999"}) {
        EXPECT_THAT(error({.labels = {wrong}}), HasSubstr("is not a label"));
    }
    EXPECT_THAT(error({.smooth = -1}), HasSubstr("smooth"));
    const auto of = [&](const std::function<int(const Vec3&)>& label) {
        return error_of([&] { (void)label_surfaces(grid_of({40, 40, 40}, label)); });
    };
    EXPECT_THAT(of([](const Vec3&) { return 0; }), HasSubstr("none has a label"));
    EXPECT_THAT(of([](const Vec3& x) { return 1 + static_cast<int>(x.x + 40 * (x.y + 40 * x.z)); }),
                HasSubstr("have 64000 labels (up to 1000"));
    EXPECT_THAT(of([](const Vec3&) { return -3; }), HasSubstr("has the label -3"));
    EXPECT_THAT(error_of([] { LabelGrid none(Mat3(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0))); }), HasSubstr("flat"));
    EXPECT_THAT(error_of([] { LabelGrid none(Mat3(1), Vec3(0, NAN, 0)); }), HasSubstr("not finite"));
    LabelGrid rows_of;
    for (const std::array<std::size_t, 3>& size :
         {std::array<std::size_t, 3>{0, 1, 1}, {std::size_t{1} << 40, 1, 1}, {std::size_t{1} << 32, std::size_t{1} << 32, 1}}) {
        EXPECT_THAT(error_of([&] { LabelRows rows(rows_of, size); }), HasSubstr("1 to 2^31"));
    }
    LabelRows rows(rows_of, {2, 2, 2});
    const std::vector<std::int64_t> few(7, 1);
    rows.take(few);
    EXPECT_THAT(error_of([&] { rows.finish(); }), HasSubstr("7 labels for 8 voxels"));
    EXPECT_THAT(error_of([&] { rows.take(few); }), HasSubstr("more labels than its 8 voxels"));
}

}  // namespace labels_test
}  // namespace subvol
