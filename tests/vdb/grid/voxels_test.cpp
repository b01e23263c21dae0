// SPDX-License-Identifier: Apache-2.0
#include "subvol/voxels.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "subvol/model.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"

namespace subvol {
namespace voxels_test {

/// Compares what the cursor returns for random voxels with the field at their centres.
void expect_cursor_fits_field(const VdbGrid& grid) {
    const auto voxels = grid.voxels();
    const auto [lower, upper] = voxels->range();
    const auto cursor = voxels->cursor();
    std::mt19937 random(3);
    const auto between = [&](std::int32_t a, std::int32_t b) {
        return std::uniform_int_distribution<std::int32_t>(a, b)(random);
    };
    const auto value = [&](const Voxel& v) {
        return grid.value(voxels->to_world() * Vec3(v[0], v[1], v[2]) + voxels->origin());
    };
    const double tolerance = 1e-9 * std::max(std::abs(grid.report().min), std::abs(grid.report().max));  // of the transforms
    std::array<int, 3> seen{};
    for (int i = 0; i < 3000; ++i) {
        Voxel v;
        for (std::size_t k = 0; k < 3; ++k) v[k] = between(lower[k] - 20, upper[k] + 20);
        const VoxelCorners corners = cursor->corners(v);
        for (int k = 0; k < 8; ++k) {
            const auto expected = value({v[0] + (k & 1), v[1] + (k >> 1 & 1), v[2] + (k >> 2)});
            ASSERT_EQ(corners.active >> k & 1, expected ? 1u : 0u);
            if (expected) {
                ASSERT_NEAR(corners.values[static_cast<std::size_t>(k)], *expected, tolerance);
            }
        }
        const VoxelBlock block = cursor->block(v);
        ++seen[static_cast<std::size_t>(block.kind)];
        for (std::size_t k = 0; k < 3; ++k) ASSERT_TRUE(block.lower[k] <= v[k] && v[k] < block.lower[k] + block.size);
        if (block.kind == VoxelBlock::Kind::Mixed) continue;
        for (int j = 0; j < 10; ++j) {
            Voxel other;
            for (std::size_t k = 0; k < 3; ++k) other[k] = between(block.lower[k], block.lower[k] + block.size - 1);
            const auto expected = value(other);
            ASSERT_EQ(expected.has_value(), block.kind == VoxelBlock::Kind::Constant);
            if (expected) {
                ASSERT_NEAR(block.value, *expected, tolerance);
            }
        }
    }
    EXPECT_GT(seen[static_cast<std::size_t>(VoxelBlock::Kind::Mixed)], 100);
    EXPECT_GT(seen[static_cast<std::size_t>(VoxelBlock::Kind::Nothing)], 100);
}

TEST(Voxels, AreThoseOfTheField) {
    const HexMesh mesh = make_model("ball");
    const std::vector<std::string> fields{"density"};
    expect_cursor_fits_field(rasterize(mesh, fields, {.resolution = 60}).front());
}

TEST(Voxels, OfAFileWithTranslation) {
    const char* folder = std::getenv("SUBVOL_DATA");
    if (!folder) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real grids";
    expect_cursor_fits_field(read_vdb(std::filesystem::path(folder) / "arnold_smoke.vdb").front());
}

}  // namespace voxels_test
}  // namespace subvol
