// SPDX-License-Identifier: Apache-2.0
#include "curved_pieces.h"

#include <gtest/gtest.h>

#include "lib/test_meshes.h"

namespace subvol::detail {
namespace curved_pieces_test {

using Sizes = std::array<std::size_t, 3>;

constexpr double kTolerance = 1e-2;

class CurvedPiecesTest : public testing::Test {
protected:
    HexMesh mesh = test::make_box(3, 1, 1);  // a row along x
    EdgeClasses edges{mesh.cells};
    std::vector<CellBend> bends = std::vector<CellBend>(mesh.cells.size());
};

TEST_F(CurvedPiecesTest, StraightCellsStayWhole) {
    const CurvedPieces pieces = choose_pieces(mesh.cells, edges, bends, kTolerance);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(pieces.of_cell(c), (Sizes{1, 1, 1}));
    EXPECT_FALSE(pieces.limited);
}

TEST_F(CurvedPiecesTest, TheDistanceFallsWithTheSquareOfThePieces) {
    bends[1].shape[0] = static_cast<float>(9 * kTolerance / 3);  // three directions share the tolerance: 3² pieces
    EXPECT_EQ(choose_pieces(mesh.cells, edges, bends, kTolerance).of_cell(1), (Sizes{3, 1, 1}));
    EXPECT_EQ(choose_pieces(mesh.cells, edges, bends, 4 * kTolerance).of_cell(1), (Sizes{2, 1, 1}));
}

TEST_F(CurvedPiecesTest, NeighboursAreSplitAlikeWhereTheyMeet) {
    bends[0].shape = {0.2F, 0, 0};
    bends[2].shape = {0, 0, 0.1F};
    const CurvedPieces pieces = choose_pieces(mesh.cells, edges, bends, kTolerance);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(pieces.of_cell(c)[2], pieces.of_cell(0)[2]);
        EXPECT_EQ(pieces.of_cell(c)[1], 1U);
        EXPECT_EQ(pieces.of_cell(c)[0] > 1, c == 0);
    }
    EXPECT_GT(pieces.of_cell(0)[2], 1U);
}

TEST_F(CurvedPiecesTest, TooManyPiecesAreFewerAndTheFieldsGiveWayFirst) {
    bends[0].shape = {0.03F, 0, 0};
    bends[0].fields = {0, 1e6F, 1e6F};
    const CurvedPieces pieces = choose_pieces(mesh.cells, edges, bends, kTolerance);
    EXPECT_TRUE(pieces.limited);
    EXPECT_EQ(pieces.of_cell(0)[0], 3U) << "the shape has all that it needs";
    std::size_t hexes = 0;
    for (std::size_t c = 0; c < 3; ++c) hexes += pieces.of_cell(c)[0] * pieces.of_cell(c)[1] * pieces.of_cell(c)[2];
    EXPECT_LE(hexes, pieces.most_hexes);
    EXPECT_GT(hexes, pieces.most_hexes / 4);
}

}  // namespace curved_pieces_test
}  // namespace subvol::detail
