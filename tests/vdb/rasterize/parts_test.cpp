// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "subvol/error.h"
#include "subvol/limit_level.h"
#include "subvol/part_of_limit.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"
#include "vdb/each_voxel.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace parts_test {

using Flags = std::vector<std::uint8_t>;
using Values = std::map<std::array<int, 3>, double>;

Values values_of(const VdbGrid& grid) {
    Values values;
    test::for_each_voxel(grid, [&](const Voxel& voxel, double value) { values[{voxel[0], voxel[1], voxel[2]}] = value; });
    return values;
}

HexMesh ball() {
    return test::with_field(test::ball_mesh(4), "f", [](const Vec3& p) { return std::sin(2 * p.x) + p.y * p.z; });
}

/// The cells of the ball on one side of a slanted plane, so that they end at stairs.
Flags half_of(const HexMesh& mesh) {
    Flags flags;
    for (const auto& cell : mesh.cells) {
        Vec3 middle(0.0);
        for (const Index p : cell) middle += mesh.points[p] / 8.0;
        flags.push_back(glm::dot(middle, Vec3(.6, .5, .62)) > .05);
    }
    return flags;
}

std::vector<VdbGrid> grids_of(const HexMesh& mesh, RasterizeOptions options, bool limit) {
    const std::vector<std::string> fields{"f"};
    options.voxel_size_world = .05;
    if (!limit) {
        options.refine.levels = 2;
        return rasterize(mesh, fields, options);
    }
    const LimitCells cells = limit_for_voxels(mesh, {}, options.voxel_size_world);
    options.limit = &cells;
    return rasterize(mesh, fields, options);
}

TEST(Parts, TwoOfThemHaveTheVoxelsOfTheWhole) {
    const HexMesh mesh = ball();
    Flags flags = half_of(mesh);
    for (const bool limit : {false, true}) {
        const Values whole = values_of(grids_of(mesh, {}, limit).front());
        std::size_t count = 0;
        for (int side = 0; side < 2; ++side) {
            const PartWithHalo part = part_with_halo(mesh, flags);
            EXPECT_LT(part.mesh.cells.size(), mesh.cells.size() + 1);
            const Values own = values_of(grids_of(part.mesh, {.cells = part.numbers}, limit).front());
            count += own.size();
            for (const auto& [voxel, value] : own) {
                const auto there = whole.find(voxel);
                ASSERT_NE(there, whole.end());
                // Of the same level the same bits; pieces of the limit are as fine as their values' ranges ask for.
                EXPECT_NEAR(value, there->second, limit ? 2e-3 : 0);
            }
            for (auto& flag : flags) flag = flag == 0;
        }
        EXPECT_EQ(count, whole.size());  // with the test above: each voxel is in one of them, if none is in both
    }
}

TEST(Parts, NoVoxelIsInTwoOfThem) {
    const HexMesh mesh = ball();
    Flags flags = half_of(mesh);
    Values numbers[2];
    for (Values& own : numbers) {
        const PartWithHalo part = part_with_halo(mesh, flags);
        own = values_of(grids_of(part.mesh, {.cells = part.numbers}, true).front());
        for (auto& flag : flags) flag = flag == 0;
    }
    EXPECT_TRUE(std::ranges::none_of(numbers[0], [&](const auto& voxel) { return numbers[1].contains(voxel.first); }));
}

/// Outside positive, of a box.
double distance_to_box(const Vec3& p, const Vec3& lower, const Vec3& upper) {
    const Vec3 beyond = glm::max(lower - p, p - upper);
    const double inside = std::min(0., std::max({beyond.x, beyond.y, beyond.z}));
    return glm::length(glm::max(beyond, Vec3(0.0))) + inside;
}

TEST(Parts, LevelSetsAndCoverageEndAtTheCut) {
    HexMesh mesh = test::with_field(test::box_mesh(4), "f", [](const Vec3& p) { return p.x; });
    Flags flags;
    for (const auto& cell : mesh.cells) flags.push_back(mesh.points[cell[0]].x < .5 && mesh.points[cell[0]].y < .5);
    const Vec3 half_a_voxel(.025);  // whole voxels are in the box: none of their centres lies on a side
    for (Vec3& p : mesh.points) p += half_a_voxel;
    const PartWithHalo part = part_with_halo(mesh, flags);
    for (const bool limit : {false, true}) {
        const auto grids =
            grids_of(part.mesh, {.cells = part.numbers, .coverage = true, .level_set = LevelSetOptions{}}, limit);
        ASSERT_EQ(grids.size(), 3u);
        const Vec3 lower = half_a_voxel, upper = half_a_voxel + Vec3(.5, .5, 1);
        EXPECT_EQ(grids[0].report().active_voxels, 10u * 10 * 20);
        double covered = 0;
        for (const auto& [voxel, value] : values_of(grids[1])) covered += value;
        EXPECT_NEAR(covered * std::pow(.05, 3), .25, 1e-9);
        std::size_t band = 0;
        for (const auto& [voxel, value] : values_of(grids[2])) {
            const Vec3 centre = .05 * Vec3(voxel[0], voxel[1], voxel[2]);
            const double distance = distance_to_box(centre, lower, upper);
            if (std::abs(distance) >= .149) continue;  // the band has three voxels
            ++band;
            EXPECT_NEAR(value, distance, 2e-6);  // floats of the band's size
        }
        EXPECT_GT(band, 2000u);
    }
}

TEST(Parts, CellsHaveTheNumbersThatTheyAreGiven) {
    const HexMesh mesh = test::with_field(test::box_mesh(4), "f", [](const Vec3& p) { return p.x; });
    Flags flags(mesh.cells.size(), 0);
    flags[21] = flags[42] = 1;
    const PartWithHalo part = part_with_halo(mesh, flags);
    for (const bool limit : {false, true}) {
        const auto grids = grids_of(part.mesh, {.cell_numbers = true, .cells = part.numbers}, limit);
        EXPECT_EQ(grids[0].report().active_voxels, 2u * 125);
        EXPECT_EQ(grids[1].report().active_voxels, 2u * 125);
        EXPECT_EQ(grids[1].report().min, 21);
        EXPECT_EQ(grids[1].report().max, 42);
    }
    const std::vector<Index> few(3, 0);
    EXPECT_THROW(std::ignore = grids_of(part.mesh, {.cells = few}, false), Error);
}

}  // namespace parts_test
}  // namespace subvol
