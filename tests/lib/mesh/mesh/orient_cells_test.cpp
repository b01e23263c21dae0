// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "lib/test_meshes.h"
#include "subvol/hex_mesh.h"

namespace subvol {
namespace orient_cells_test {

void exchange(std::array<Index, 8>& cell) {
    std::swap_ranges(cell.begin(), cell.begin() + 4, cell.begin() + 4);
}

TEST(OrientCells, LeftHandedCellsAreTurned) {
    const HexMesh expected = test::make_box(3, 3, 3);
    HexMesh mesh = expected;
    for (std::size_t c = 0; c < mesh.cells.size(); c += 4) exchange(mesh.cells[c]);
    EXPECT_EQ(orient_cells(mesh), 7u);
    EXPECT_EQ(mesh.cells, expected.cells);
    EXPECT_EQ(orient_cells(mesh), 0u);
    for (auto& cell : mesh.cells) exchange(cell);
    EXPECT_EQ(orient_cells(mesh), 27u);
    EXPECT_EQ(mesh.cells, expected.cells);
}

// The cell's own volume is negative, but it sees its faces as a right-handed cell does.
TEST(OrientCells, FoldedCellsAreNot) {
    HexMesh mesh = test::make_box(3, 3, 3);
    for (Vec3& p : mesh.points) {
        if (p == Vec3(1, 1, 1)) p = Vec3(2.6, 2.6, 2.6);
    }
    HexMesh expected = mesh;
    EXPECT_EQ(orient_cells(mesh), 0u);
    EXPECT_EQ(mesh.cells, expected.cells);
    exchange(mesh.cells[2]);
    EXPECT_EQ(orient_cells(mesh), 1u);
    EXPECT_EQ(mesh.cells, expected.cells);
}

TEST(OrientCells, EachPartHasItsOwnHand) {
    HexMesh mesh = test::make_box(2, 2, 2);
    const HexMesh other = test::make_box(1, 1, 1);
    for (const Vec3& p : other.points) mesh.points.push_back(p + Vec3(9, 0, 0));
    auto cell = other.cells[0];
    for (Index& p : cell) p += 27;
    exchange(cell);
    mesh.cells.push_back(cell);
    EXPECT_EQ(orient_cells(mesh), 1u);
    exchange(cell);
    EXPECT_EQ(mesh.cells.back(), cell);
}

}  // namespace orient_cells_test
}  // namespace subvol
