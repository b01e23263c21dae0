// SPDX-License-Identifier: Apache-2.0
// Reads with NanoVDB's own reader, as other programs do.
#include "subvol/nanovdb.h"
#include "subvol/rasterize.h"

#include <gtest/gtest.h>
#include <nanovdb/util/IO.h>
#include <unistd.h>

#include <bit>
#include <filesystem>

#include "vdb/each_voxel.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace nanovdb_test {

namespace fs = std::filesystem;
using namespace test;

class NanoVdb : public ::testing::Test {
protected:
    NanoVdb() : folder_(fs::temp_directory_path() / ("subvol_nanovdb_" + std::to_string(::getpid()))) {
        fs::create_directory(folder_);
    }
    ~NanoVdb() override { fs::remove_all(folder_); }

    fs::path folder_;
};

std::vector<VdbGrid> all_kinds() {
    HexMesh mesh = with_field(jittered_box_mesh(3), "heat", [](const Vec3& p) { return std::sin(9 * p.x) * p.y + p.z; });
    Attribute vel{"vel", 3, {}};
    for (const Vec3& p : mesh.points) vel.values.insert(vel.values.end(), {p.y, -p.x, 2 * p.z});
    mesh.attributes.push_back(vel);
    const std::vector<std::string> fields{"heat", "vel"};
    return rasterize(mesh, fields,
                     {.voxel_size_world = 0.04, .cell_numbers = true, .mask = true, .level_set = LevelSetOptions{}});
}

void expect_same_floats(const VdbGrid& expected, const nanovdb::FloatGrid* actual) {
    ASSERT_NE(actual, nullptr);
    EXPECT_EQ(actual->gridName(), expected.report().name);
    EXPECT_EQ(actual->activeVoxelCount(), expected.report().active_voxels);
    EXPECT_EQ(actual->voxelSize()[0], expected.report().voxel_size_world);
    const auto accessor = actual->getAccessor();
    std::size_t compared = 0;
    for_each_voxel(expected, [&](const Voxel& v, double value) {
        const nanovdb::Coord at(v[0], v[1], v[2]);
        ASSERT_TRUE(accessor.isActive(at));
        ASSERT_EQ(std::bit_cast<std::uint32_t>(accessor.getValue(at)), std::bit_cast<std::uint32_t>(static_cast<float>(value)));
        ++compared;
    });
    EXPECT_GT(compared, 1000u);
}

TEST_F(NanoVdb, HoldsTheSameBits) {
    ASSERT_TRUE(has_nanovdb());
    const auto grids = all_kinds();
    write_nanovdb(folder_ / "a.nvdb", grids);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
    const auto read = nanovdb::io::readGrids((folder_ / "a.nvdb").string());
    ASSERT_EQ(read.size(), 5u);
    expect_same_floats(grids[0], read[0].grid<float>());
    expect_same_floats(grids[4], read[4].grid<float>());
    EXPECT_TRUE(read[0].grid<float>()->isFogVolume());
    EXPECT_TRUE(read[4].grid<float>()->isLevelSet());

    const auto* vel = read[1].grid<nanovdb::Vec3f>();
    const auto* cells = read[2].grid<std::int32_t>();
    const auto* mask = read[3].grid<nanovdb::ValueMask>();
    ASSERT_TRUE(vel && cells && mask);
    for (const auto& [grid, count] : {std::pair(1, vel->activeVoxelCount()), std::pair(2, cells->activeVoxelCount()),
                                      std::pair(3, mask->activeVoxelCount())}) {
        EXPECT_EQ(count, grids[static_cast<std::size_t>(grid)].report().active_voxels);
    }
    const auto at = vel->getAccessor();
    for_each_voxel(grids[0], [&](const Voxel& v, double) {
        const nanovdb::Vec3f value = at.getValue(nanovdb::Coord(v[0], v[1], v[2]));
        ASSERT_NEAR(static_cast<double>(value[0]), 0.04 * v[1], 1e-6);  // the field is linear
        ASSERT_NEAR(static_cast<double>(value[1]), -0.04 * v[0], 1e-6);
        ASSERT_TRUE(mask->getAccessor().isActive(nanovdb::Coord(v[0], v[1], v[2])));
    });
}

TEST_F(NanoVdb, OfNothing) {
    const auto mesh = with_field(box_mesh(1, Vec3(0.1), Vec3(0.2)), "f", [](const Vec3&) { return 1.0; });
    const std::vector<std::string> fields{"f"};
    write_nanovdb(folder_ / "a.nvdb", rasterize(mesh, fields, {.voxel_size_world = 1}));
    EXPECT_EQ(nanovdb::io::readGrids((folder_ / "a.nvdb").string()).front().grid<float>()->activeVoxelCount(), 0u);
}

}  // namespace nanovdb_test
}  // namespace subvol
