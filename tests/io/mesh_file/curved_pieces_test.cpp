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

    [[nodiscard]] CurvedPieces choose(double tolerance, std::size_t most_hexes = 100'000) const {
        return choose_pieces(mesh.cells, edges, bends, tolerance, most_hexes);
    }
};

TEST_F(CurvedPiecesTest, StraightCellsStayWhole) {
    const CurvedPieces pieces = choose(kTolerance);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(pieces.of_cell(c), (Sizes{1, 1, 1}));
    EXPECT_FALSE(pieces.limited);
}

TEST_F(CurvedPiecesTest, TheDistanceFallsWithTheSquareOfThePieces) {
    bends[1].shape[0] = static_cast<float>(9 * kTolerance / 3);  // three directions share the tolerance: 3² pieces
    EXPECT_EQ(choose(kTolerance).of_cell(1), (Sizes{3, 1, 1}));
    EXPECT_EQ(choose(4 * kTolerance).of_cell(1), (Sizes{2, 1, 1}));
}

TEST_F(CurvedPiecesTest, NeighboursAreSplitAlikeWhereTheyMeet) {
    bends[0].shape = {0.2F, 0, 0};
    bends[2].shape = {0, 0, 0.1F};
    const CurvedPieces pieces = choose(kTolerance);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(pieces.of_cell(c)[2], pieces.of_cell(0)[2]);
        EXPECT_EQ(pieces.of_cell(c)[1], 1U);
        EXPECT_EQ(pieces.of_cell(c)[0] > 1, c == 0);
    }
    EXPECT_GT(pieces.of_cell(0)[2], 1U);
}

TEST_F(CurvedPiecesTest, FieldsNeedLessOnceAllNodesAreMet) {
    bends[1].fields[0] = static_cast<float>(400 * 16 * kTolerance / 3);
    EXPECT_EQ(choose(kTolerance).of_cell(1), (Sizes{2, 1, 1})) << "16 / 8 parts of the tolerance in one piece, 1/2 in two";
    for (auto& bend : bends) bend.degrees = {3, 3, 3};
    EXPECT_EQ(choose(kTolerance).of_cell(1), (Sizes{3, 1, 1})) << "two pieces miss nodes and are 4 tolerances off";
}

// Where the hexahedra end, the errors of shape and fields are about the same part of their tolerances, however they are spread
// over directions, and a smaller tolerance changes nothing more.
TEST_F(CurvedPiecesTest, TooFewHexahedraAreSharedByShapeAndFields) {
    constexpr std::size_t kMost = 3000;
    bends[0].shape = {0, 0.03F, 0};
    bends[0].fields = {0, 0, 6.F};
    bends[2].shape = {0.003F, 0, 0};
    const CurvedPieces pieces = choose(1e-12, kMost);
    EXPECT_TRUE(pieces.limited);
    EXPECT_LE(pieces.hexes, kMost);
    EXPECT_GT(pieces.hexes, kMost / 2);
    std::size_t hexes = 0;
    for (std::size_t c = 0; c < 3; ++c) hexes += pieces.of_cell(c)[0] * pieces.of_cell(c)[1] * pieces.of_cell(c)[2];
    EXPECT_EQ(hexes, pieces.hexes);
    const auto error = [&](std::size_t c, std::size_t axis) {
        const std::size_t n = pieces.of_cell(c)[axis];
        const auto squared = static_cast<double>(n * n);
        return std::max(bends[c].shape[axis] / squared, fields_error(bends[c].fields[axis], 1, n) / 400);
    };
    EXPECT_LT(std::max({error(0, 1), error(0, 2), error(2, 0)}), 4 * std::min({error(0, 1), error(0, 2), error(2, 0)}));
    EXPECT_EQ(choose(1e-13, kMost).of_class, pieces.of_class);
}

TEST_F(CurvedPiecesTest, ASmallerToleranceOnlyAddsPieces) {
    bends[0].shape = {0.02F, 0.03F, 0.001F};
    bends[1].fields = {8.F, 1.F, 2.F};
    bends[2].shape = {0.5F, 0, 0};
    std::vector<std::size_t> before(edges.size(), 1);
    for (double tolerance = 1; tolerance > 1e-7; tolerance *= .7) {
        const CurvedPieces pieces = choose(tolerance, 20'000);
        for (std::size_t e = 0; e < before.size(); ++e) EXPECT_GE(pieces.of_class[e], before[e]) << tolerance;
        before = pieces.of_class;
    }
}

}  // namespace curved_pieces_test
}  // namespace subvol::detail
