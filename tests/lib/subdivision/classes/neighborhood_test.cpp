// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/neighborhood.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lib/test_meshes.h"
#include "subvol/detail/patch.h"
#include "subvol/model.h"

namespace subvol {
namespace neighborhood_test {

using detail::NeighborhoodWalk;

// Without the second layer the same cells are regular, and their points are the inner ones of both layers.
TEST(Neighborhood, RegularPointsOfOneLayerAreTheInnerOnesOfTwo) {
    HexMesh turned = test::make_box(7, 6, 6);
    for (std::size_t c = 0; c < turned.cells.size(); c += 3) {  // about the w axis
        const auto first = turned.cells[c].begin();
        std::rotate(first, first + 1, first + 4);
        std::rotate(first + 4, first + 5, first + 8);
    }
    for (const HexMesh& mesh : {test::make_box(7, 6, 6), turned, make_model("ball", 6)}) {
        const auto links = detail::build_links(mesh);
        const NeighborhoodWalk walk(mesh, links);
        std::array<Index, 216> two{};
        std::array<Index, 64> one{};
        std::size_t regular = 0;
        for (Index c = 0; c < mesh.cells.size(); ++c) {
            const bool is_regular = walk.find_regular(c, two);
            ASSERT_EQ(walk.find_regular(c, one), is_regular);
            if (!is_regular) continue;
            ++regular;
            for (std::size_t n = 0; n < 64; ++n) {
                ASSERT_EQ(one[n], two[n % 4 + 1 + 6 * (n / 4 % 4 + 1) + 36 * (n / 16 + 1)]);
            }
        }
        EXPECT_GT(regular, 0u);
    }
}

// Patches of a few cells need the cells that a walk has found around them, and no others.
TEST(Neighborhood, HasAllCellsOfAPatch) {
    HexMesh mesh = make_model("ball", 6);
    mesh.creases = {{mesh.cells[0][0], mesh.cells[0][1]}};
    mesh.sharp_faces = {{mesh.cells[0][0], mesh.cells[0][1], mesh.cells[0][2], mesh.cells[0][3]}};
    const auto links = detail::build_links(mesh);
    NeighborhoodWalk walk(mesh, links);
    detail::Neighborhood found;
    const std::vector<Index> wanted{300, 0, 7};
    std::vector<Index> around;
    for (const Index cell : wanted) {
        ASSERT_TRUE(walk.find(cell, 2, found));
        for (const auto& visited : walk.visited()) around.push_back(visited.cell);
    }
    std::ranges::sort(around);
    around.erase(std::unique(around.begin(), around.end()), around.end());
    ASSERT_LT(around.size(), mesh.cells.size() / 2);
    const detail::Patch few = detail::PatchSource(mesh, around).cut(wanted, 2), all = detail::PatchSource(mesh).cut(wanted, 2);
    EXPECT_EQ(few.mesh.cells, all.mesh.cells);
    EXPECT_EQ(few.mesh.points, all.mesh.points);
    EXPECT_EQ(few.mesh.creases, all.mesh.creases);
    EXPECT_EQ(few.mesh.sharp_faces, all.mesh.sharp_faces);
    EXPECT_FALSE(all.mesh.creases.empty());
    EXPECT_EQ(few.first_layer, all.first_layer);
}

}  // namespace neighborhood_test
}  // namespace subvol
