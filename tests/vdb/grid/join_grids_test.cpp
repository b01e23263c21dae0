// SPDX-License-Identifier: Apache-2.0
#include "subvol/join_grids.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/temp_folder.h"
#include "subvol/error.h"
#include "subvol/rasterize.h"
#include "subvol/split.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace join_grids_test {

using namespace test;

const std::vector<std::string> kField{"f"};

HexMesh bent_box() {
    return with_field(jittered_box_mesh(4), "f", [](const Vec3& p) { return std::sin(5 * p.x) * std::cos(4 * p.y) + p.z; });
}

RasterizeOptions all_kinds() {
    RasterizeOptions options{.voxel_size_world = 0.011, .cell_numbers = true, .mask = true, .coverage = true};
    options.level_set = LevelSetOptions{};
    options.metadata = {{"made", "here"}};
    return options;
}

std::vector<VdbGrid> joined(const HexMesh& mesh, const RasterizeOptions& options, int count) {
    std::vector<std::vector<VdbGrid>> shares;
    for (int part = 1; part <= count; ++part) shares.push_back(rasterize_share(mesh, kField, options, {part, count}).grids);
    std::vector<VdbGrid> grids;
    for (std::size_t g = 0; g < shares.front().size(); ++g) {
        std::vector<VdbGrid> parts;
        for (std::vector<VdbGrid>& share : shares) parts.push_back(std::move(share[g]));
        grids.push_back(join_grids(std::move(parts)));
    }
    return grids;
}

TEST(JoinGrids, SharesHaveTheBitsOfOnePiece) {
    const HexMesh mesh = bent_box();
    const RasterizeOptions options = all_kinds();
    const std::vector<VdbGrid> whole = rasterize(mesh, kField, options);
    for (const int count : {1, 2, 3, 4, 7, 30}) {  // the last has more shares than layers of bricks
        const std::vector<VdbGrid> grids = joined(mesh, options, count);
        ASSERT_EQ(grids.size(), whole.size());
        for (std::size_t g = 0; g < whole.size(); ++g) {
            EXPECT_EQ(hash_of_grid(grids[g]), hash_of_grid(whole[g])) << whole[g].report().name << " of " << count;
            EXPECT_EQ(text_of_grid(grids[g], "made"), "here");
        }
    }
}

class GridsOfPieces : public TempFolder {};

// A mesh in bricks is made block by block of voxels, or share by share: its grids are those of the mesh in memory.
TEST_F(GridsOfPieces, HaveTheBitsOfAMeshInMemory) {
    const HexMesh mesh = bent_box();
    const Bricks bricks = split_mesh(path("m.bricks"), mesh, {.bricks = 5}).bricks;
    RasterizeOptions options{.voxel_size_world = 0.011, .mask = true};
    const std::vector<VdbGrid> whole = rasterize(mesh, kField, options);
    std::vector<std::vector<VdbGrid>> blocks(whole.size());
    int parts = 0;
    const PartsReport report = rasterize_parts(bricks, kField, options, 300'000, [&](GridPart part) {
        EXPECT_EQ(part.number, parts++);
        for (std::size_t g = 0; g < blocks.size(); ++g) blocks[g].push_back(std::move(part.grids.at(g)));
    });
    EXPECT_GT(parts, 1);
    EXPECT_GE(report.blocks, static_cast<std::size_t>(parts));
    EXPECT_TRUE(report.converged);
    for (std::size_t g = 0; g < whole.size(); ++g) {
        EXPECT_EQ(hash_of_grid(join_grids(std::move(blocks[g]))), hash_of_grid(whole[g])) << whole[g].report().name;
    }
    for (const int count : {1, 3, 30}) {
        std::vector<VdbGrid> shares;
        for (int part = 1; part <= count; ++part) {
            shares.push_back(std::move(rasterize_share(bricks, kField, options, {part, count}).grids.front()));
        }
        EXPECT_EQ(hash_of_grid(join_grids(std::move(shares))), hash_of_grid(whole.front())) << count;
    }
    options.voxel_size_world = 0;
    EXPECT_THROW((void)rasterize_share(bricks, kField, options, {1, 2}), Error);
}

// Tiles of one value that fill an inner node are merged only when all shares are there.
TEST(JoinGrids, MergesTilesOfTheWhole) {
    const HexMesh mesh = with_field(jittered_box_mesh(1), "f", [](const Vec3&) { return 2.0; });
    const RasterizeOptions options{.voxel_size_world = 1.0 / 300};
    const std::vector<VdbGrid> whole = rasterize(mesh, kField, options);
    EXPECT_EQ(hash_of_grid(joined(mesh, options, 3).front()), hash_of_grid(whole.front()));
}

TEST(JoinGrids, BytesAreTheGrids) {
    const std::vector<VdbGrid> whole = rasterize(bent_box(), kField, all_kinds());
    const std::vector<VdbGrid> back = detail::grids_from_bytes(detail::bytes_of_grids(whole));
    ASSERT_EQ(back.size(), whole.size());
    for (std::size_t g = 0; g < whole.size(); ++g) EXPECT_EQ(hash_of_grid(back[g]), hash_of_grid(whole[g]));
    EXPECT_THROW((void)detail::grids_from_bytes("nothing"), Error);
}

TEST(JoinGrids, HashesDifferWhereVoxelsDo) {
    const HexMesh mesh = bent_box();
    const std::uint64_t one = hash_of_grid(rasterize(mesh, kField, {.voxel_size_world = 0.02}).front());
    EXPECT_NE(one, hash_of_grid(rasterize(mesh, kField, {.voxel_size_world = 0.021}).front()));
    HexMesh other = mesh;
    other.attributes.front().values.front() += 1e-3;
    EXPECT_NE(one, hash_of_grid(rasterize(other, kField, {.voxel_size_world = 0.02}).front()));
}

TEST(JoinGrids, RefusesWhatDoesNotFit) {
    const HexMesh mesh = bent_box();
    const auto share = [&](int part, double voxel) {
        return std::move(rasterize_share(mesh, kField, {.voxel_size_world = voxel}, {part, 2}).grids.front());
    };
    const auto join = [](VdbGrid a, VdbGrid b) {
        std::vector<VdbGrid> parts;
        parts.push_back(std::move(a));
        parts.push_back(std::move(b));
        return join_grids(std::move(parts));
    };
    EXPECT_THROW((void)join(share(1, 0.02), share(1, 0.02)), Error);
    EXPECT_THROW((void)join(share(1, 0.02), share(2, 0.03)), Error);
    EXPECT_THROW((void)join_grids({}), Error);
    EXPECT_THROW((void)rasterize_share(mesh, kField, {.voxel_size_world = 0.02}, {3, 2}), Error);
}

}  // namespace join_grids_test
}  // namespace subvol
