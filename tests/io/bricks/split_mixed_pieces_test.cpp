// SPDX-License-Identifier: Apache-2.0
// Tetrahedra, prisms and pyramids in pieces are split into the hexahedra of the whole mesh, without being held.
#include <gmock/gmock.h>

#include <random>

#include "mesh_in_pieces.h"
#include "subvol/model.h"

namespace subvol {
namespace split_mixed_pieces_test {

using test::error_of;
using test::Extras;
using test::PlainMesh;
using testing::Contains;
using testing::HasSubstr;

class SplitMixedPieces : public test::MeshInPieces {};

// A box of hexahedra, of which a column is cut into prisms, with a tetrahedron on each prism and, if they are asked for, a
// pyramid on every second hexahedron at the top. Some of each kind are left-handed.
PlainMesh house(bool hexes, bool pyramids) {
    const Index n = 4;
    HexMesh box = test::make_box(3, 3, 3);
    test::jitter(box, 0.05, 11);
    PlainMesh mesh;
    mesh.points = box.points;
    const auto add_apex = [&](std::vector<Index> base) {
        Vec3 sum(0);
        for (const Index p : base) sum += mesh.points[p];
        base.push_back(static_cast<Index>(mesh.points.size()));
        mesh.points.push_back(sum / static_cast<double>(base.size() - 1) + Vec3(0, 0, 0.7));
        mesh.cells.push_back(std::move(base));
    };
    for (const auto& c : box.cells) {
        const bool column = box.points[c[0]].x > 1.5;
        const bool top = box.points[c[4]].z > 2.5;
        if (!column) {
            if (hexes) mesh.cells.emplace_back(c.begin(), c.end());
            if (pyramids && top && c[0] % 2 == 0) add_apex({c[4], c[5], c[6], c[7]});
            continue;
        }
        for (const auto& [i, j, k] : {std::array<std::size_t, 3>{0, 1, 2}, std::array<std::size_t, 3>{0, 2, 3}}) {
            mesh.cells.push_back({c[i], c[j], c[k], c[i + 4], c[j + 4], c[k + 4]});
            if (top) add_apex({c[i + 4], c[j + 4], c[k + 4]});
        }
    }
    for (std::size_t c = 0; c < mesh.cells.size(); c += 3) {
        std::vector<Index>& cell = mesh.cells[c];
        if (cell.size() == 4) std::swap(cell[0], cell[1]);
        if (cell.size() == 5) std::swap(cell[1], cell[3]);
        if (cell.size() == 6) std::swap_ranges(cell.begin(), cell.begin() + 3, cell.begin() + 3);
        if (cell.size() == 8) std::swap_ranges(cell.begin(), cell.begin() + 4, cell.begin() + 4);
    }
    EXPECT_EQ(box.points.size(), n * n * n);
    return mesh;
}

std::vector<int> pieces_of(const PlainMesh& mesh, bool at_random) {
    std::vector<int> piece_of;
    std::mt19937 dice(7);
    for (const auto& cell : mesh.cells) {
        const Vec3& x = mesh.points[cell[0]];
        piece_of.push_back(at_random ? static_cast<int>(dice() % 4) : (x.x > 1.5 ? 1 : 0) + (x.z > 1.5 ? 2 : 0));
    }
    return piece_of;
}

TEST_F(SplitMixedPieces, TheBricksAreThoseOfTheWhole) {
    for (int k = 0; k < 32; ++k) {
        const PlainMesh mesh = house(k % 5 != 4, (k & 16) != 0);
        const Extras extras{.point_numbers = (k & 1) != 0,
                            .cell_numbers = (k & 2) != 0,
                            .cell_field = (k & 4) != 0,
                            .ghosts = (k & 8) != 0,
                            .apart = (k & 1) != 0 ? 1e-8 : 0};
        const std::filesystem::path pieces = write_pieces(mesh, pieces_of(mesh, k % 3 == 0), extras);
        const BrickShape shape = k % 2 == 0 ? BrickShape::Blocks : BrickShape::Random;
        expect_same_bricks(pieces, {.bricks = 5, .shape = shape, .halo_layers = 1 + k % 3}, "case " + std::to_string(k) + ": ",
                           {.crease_angle_deg = 0});
    }
}

TEST_F(SplitMixedPieces, MoreCellsThanAreSplitTogether) {
    const HexMesh box = make_model("twist", 42);  // 74088 hexahedra, of which one is cut into prisms
    PlainMesh mesh(box);
    const std::vector<Index> c = mesh.cells.back();
    mesh.cells.back() = {c[0], c[1], c[2], c[4], c[5], c[6]};
    mesh.cells.push_back({c[0], c[2], c[3], c[4], c[6], c[7]});
    expect_same_bricks(write_pieces(mesh, std::vector<int>(mesh.cells.size(), 0), {.ghosts = false}), {.bricks = 2}, "",
                       {.crease_angle_deg = 0});
}

// Sharp edges are those of the cells before they are split.
TEST_F(SplitMixedPieces, CellsWhoseSharpEdgesAreKeptAreHeldWhole) {
    const PlainMesh mesh = house(true, true);
    (void)write_pieces(mesh, pieces_of(mesh, false), {});
    const PiecesSplit split = split_pieces(path("b.bricks"), path("all.pvtu"), {}, {.bricks = 2});
    EXPECT_THAT(split.held_whole, HasSubstr("sharp edges are those of its cells before they are split"));
}

TEST_F(SplitMixedPieces, WhatHappenedToTheCellsIsSaid) {
    const PlainMesh mesh = house(true, true);
    (void)write_pieces(mesh, pieces_of(mesh, false), {});
    const PiecesSplit split =
        split_pieces(path("b.bricks"), path("all.pvtu"), {.read = {.crease_angle_deg = 0}}, {.bricks = 2});
    EXPECT_THAT(split.warnings,
                Contains(HasSubstr("18 hexahedra, 6 tetrahedra, 18 prisms and 3 pyramids cut into 174 tetrahedra "
                                   "and split into 696 hexahedra, the hexahedra too")));
    EXPECT_THAT(split.warnings, Contains(HasSubstr("of 18 hexahedra were left-handed")));
}

TEST_F(SplitMixedPieces, RefusedCellsAndTwinsAreSaidAsOfTheWhole) {
    PlainMesh mesh = house(true, false);
    (void)write_pieces(mesh, pieces_of(mesh, false), {.ghosts = false});
    const PiecesOptions refusing{.read = {.other_cells = OtherCells::Refuse}};
    EXPECT_EQ(split_pieces(path("b.bricks"), path("all.pvtu"), refusing).held_whole, "it has other cells than hexahedra");
    const std::vector<Index> prism = *std::ranges::find(mesh.cells, std::size_t{6}, &std::vector<Index>::size);
    mesh.cells.push_back(prism);
    mesh.cells.push_back(mesh.cells.front());
    (void)write_pieces(mesh, pieces_of(mesh, false), {.ghosts = false});
    const std::string whole = error_of([&] { (void)read_mesh(path("all.pvtu")); });
    EXPECT_THAT(whole, HasSubstr("two cells have the same corners: points"));
    const std::size_t files = file_count();
    const PiecesOptions by_pieces{.read = {.crease_angle_deg = 0}};
    EXPECT_EQ(error_of([&] { (void)split_pieces(path("b.bricks"), path("all.pvtu"), by_pieces, {.bricks = 2}); }), whole);
    EXPECT_EQ(file_count(), files);
}

}  // namespace split_mixed_pieces_test
}  // namespace subvol
