// SPDX-License-Identifier: Apache-2.0
// Pieces of a mesh put together: by the places of their points or by their numbers.
#include "join_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "made_files.h"

namespace subvol::detail {
namespace join_pieces_test {

using test::add_at_cells;
using test::add_at_points;
using test::assembled;
using test::file_of;
using test::make_box;
using test::open_area;
using test::volume_of;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// The number of a place in a box of 4 × 2 × 2 cells.
double number_of(const Vec3& x) {
    return x.x + 5 * (x.y + 3 * x.z);
}

/// Cells i to i + 1 of that box, with the number of each point and cell in the whole.
MeshFile slab(int from, int to) {
    HexMesh mesh = make_box(static_cast<Index>(to - from), 2, 2);
    for (Vec3& x : mesh.points) x.x += from;
    MeshFile file = file_of(mesh);
    add_at_points(file, "f", [](const Vec3& x) { return 2 * x.x - x.y; });
    FileArray cells{"c", 1, true, {}};
    for (const auto& cell : mesh.cells) cells.values.push_back(test::mean_at(mesh.points, cell).x);
    file.arrays.push_back(cells);
    return file;
}

void number_points(MeshFile& piece, const std::string& name) {
    add_at_points(piece, name, [](const Vec3& x) { return number_of(x); });
}

void number_cells(MeshFile& piece) {
    std::vector<double> numbers;
    for (const auto& cell : piece.hexes.corners) numbers.push_back(number_of(piece.points[cell[0]]));
    add_at_cells(piece, "GlobalCellId", numbers);
}

std::vector<MeshFile> pieces_of_box() {
    return {slab(2, 4), slab(0, 1), slab(1, 2)};
}

MeshFile joined(std::vector<MeshFile> pieces) {
    return join_pieces(std::move(pieces), "piece", test::kMadeFile);
}

/// The box is whole, and each value is that of its place.
void expect_box(const MeshFile& whole) {
    const ReadResult result = assembled(whole);
    EXPECT_EQ(result.mesh.points.size(), 45U);
    EXPECT_NEAR(volume_of(result.mesh), 16, 1e-12);
    EXPECT_NEAR(open_area(result.mesh), 2 * 4 + 4 * 8, 1e-12);
    const Attribute* f = result.mesh.find_attribute("f");
    const Attribute* c = result.mesh.find_attribute("c");
    ASSERT_TRUE(f != nullptr && c != nullptr);
    for (std::size_t p = 0; p < result.mesh.points.size(); ++p) {
        EXPECT_EQ(f->values[p], 2 * result.mesh.points[p].x - result.mesh.points[p].y);
    }
    for (std::size_t k = 0; k < result.mesh.cells.size(); ++k) {
        EXPECT_EQ(c->cells[k], test::mean_at(result.mesh.points, result.mesh.cells[k]).x);
    }
}

/// Points with an array of their own, and no cell that is read.
MeshFile surface_block() {
    MeshFile file;
    file.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    file.arrays.push_back({"aperture", 1, true, {7}});
    file.warnings.emplace_back("1 quad ignored");
    file.blocks.push_back({"fault", 0});
    return file;
}

TEST(JoinPieces, WhatHasNoCellsTakesNoArraysAway) {
    for (const bool first : {true, false}) {
        std::vector<MeshFile> pieces;
        if (first) pieces.push_back(surface_block());
        pieces.push_back(slab(0, 2));
        pieces.push_back(slab(2, 4));
        if (!first) pieces.push_back(surface_block());
        const MeshFile whole = join_pieces(std::move(pieces), "block", test::kMadeFile);
        const ReadResult result = assembled(whole);
        EXPECT_NEAR(volume_of(result.mesh), 16, 1e-12);
        ASSERT_EQ(result.fields.size(), 2U);
        EXPECT_THAT(result.warnings, Contains("1 quad ignored"));
        EXPECT_THAT(result.warnings, Contains(HasSubstr("2 blocks put together; 9 points joined")));
        EXPECT_EQ(result.fields[1].name, "c");
    }
    // Alone it is an error of its own.
    std::vector<MeshFile> alone;
    alone.push_back(surface_block());
    EXPECT_EQ(join_pieces(std::move(alone), "block", test::kMadeFile).points.size(), 4U);
}

TEST(JoinPieces, JoinsPointsAtTheSamePlace) {
    const MeshFile whole = joined(pieces_of_box());
    expect_box(whole);
    EXPECT_THAT(whole.warnings, ElementsAre("3 pieces put together; 18 points joined with those of another, by their places"));
    EXPECT_EQ(whole.points.front(), Vec3(2, 0, 0)) << "the points of the first piece come first";
    std::vector<MeshFile> apart = pieces_of_box();
    for (Vec3& x : apart[1].points) x.x -= 1e-9;
    EXPECT_EQ(joined(apart).points.size(), 45U + 9);
}

TEST(JoinPieces, MinusZeroIsZero) {
    std::vector<MeshFile> pieces = pieces_of_box();
    for (Vec3& x : pieces[1].points) x.y = x.y == 0 ? -0.0 : x.y;
    EXPECT_EQ(joined(pieces).points.size(), 45U);
}

// Two points of one piece at one place stay apart, as where a mesh is cut open.
TEST(JoinPieces, LeavesThePointsOfAPieceAlone) {
    MeshFile cut = slab(0, 1);
    for (const Vec3& x : slab(0, 1).points) cut.points.push_back(x);
    for (auto& array : cut.arrays) {
        if (!array.at_cells) array.values.insert(array.values.end(), array.values.begin(), array.values.begin() + 18);
    }
    MeshFile right = slab(1, 2);
    EXPECT_EQ(joined({cut, right}).points.size(), 36U + 9);
    number_points(cut, "GlobalNodeId");
    number_points(right, "GlobalNodeId");
    const MeshFile whole = joined({cut, right});
    EXPECT_EQ(whole.points.size(), 36U + 9) << "a number that a piece has twice is no number of a point";
    EXPECT_THAT(whole.warnings, Contains("array \"GlobalNodeId\" does not number the points: not used"));
}

TEST(JoinPieces, JoinsPointsOfTheSameNumber) {
    for (const std::string_view name : kPointNumberArrays) {
        std::vector<MeshFile> pieces = pieces_of_box();
        for (MeshFile& piece : pieces) {
            number_points(piece, std::string(name));
            number_cells(piece);
        }
        for (Vec3& x : pieces[1].points) x += Vec3(1e-9);  // as where numbers are rounded
        const MeshFile whole = joined(pieces);
        ASSERT_EQ(whole.points.size(), 45U);
        for (std::size_t p = 0; p < 45; ++p) EXPECT_NEAR(number_of(whole.points[p]), static_cast<double>(p), 1e-7);
        const std::vector<double>& c = find_array(whole, "c", true, 1)->values;
        double before = -1;
        for (std::size_t k = 0; k < whole.hexes.corners.size(); ++k) {
            const double number = number_of(whole.points[whole.hexes.corners[k][0]]);
            EXPECT_GT(number, before) << "cells are in the order of their numbers";
            before = number;
            EXPECT_NEAR(c[whole.hexes.numbers[k]], test::mean_at(whole.points, whole.hexes.corners[k]).x, 1e-7);
        }
        EXPECT_THAT(whole.warnings,
                    Contains(HasSubstr("by \"" + std::string(name) + "\"; cells in the order of \"GlobalCellId\"")));
        EXPECT_EQ(find_array(whole, "GlobalCellId", true, 1), nullptr);
    }
}

TEST(JoinPieces, NumbersThatAreNoNumbersOfPointsAreNotUsed) {
    const auto first_of = [](MeshFile& piece) -> double& { return piece.arrays.back().values.front(); };
    const std::vector<std::pair<std::string, std::function<void(std::vector<MeshFile>&)>>> faults{
        {"not whole", [&](auto& pieces) { first_of(pieces[2]) += 0.5; }},
        {"not a number", [&](auto& pieces) { first_of(pieces[2]) = std::nan(""); }},
        {"twice in a piece", [&](auto& pieces) { first_of(pieces[0]) = pieces[0].arrays.back().values[5]; }},
        {"at two places", [&](auto& pieces) { first_of(pieces[1]) = 44; }}};
    for (const auto& [what, damage] : faults) {
        std::vector<MeshFile> pieces = pieces_of_box();
        for (MeshFile& piece : pieces) number_points(piece, "GlobalNodeId");
        damage(pieces);
        const MeshFile whole = joined(pieces);
        expect_box(whole);
        EXPECT_THAT(whole.warnings, Contains("array \"GlobalNodeId\" does not number the points: not used")) << what;
        EXPECT_THAT(whole.warnings, Contains(HasSubstr("by their places"))) << what;
    }
    std::vector<MeshFile> pieces = pieces_of_box();
    number_points(pieces[0], "GlobalNodeId");
    EXPECT_THAT(joined(pieces).warnings, Contains("array \"GlobalNodeId\" ignored: it is not in every piece"));
}

TEST(JoinPieces, NumbersOfCellsHaveToBeDifferent) {
    std::vector<MeshFile> pieces = pieces_of_box();
    for (MeshFile& piece : pieces) number_cells(piece);
    pieces[0].arrays.back().values[1] = pieces[1].arrays.back().values[0];
    const MeshFile whole = joined(pieces);
    EXPECT_THAT(whole.warnings, Contains("array \"GlobalCellId\" does not number the cells: not used"));
    EXPECT_EQ(whole.points[whole.hexes.corners[0][0]], Vec3(2, 0, 0)) << "in the order of the pieces";
    // A ghost has the number of another piece's cell.
    add_at_cells(pieces[0], std::string(kGhostArray), {0, 1, 0, 0, 0, 0, 0, 0});
    const MeshFile ordered = joined(pieces);
    EXPECT_THAT(ordered.warnings, Contains(HasSubstr("cells in the order of \"GlobalCellId\"")));
    EXPECT_EQ(volume_of(assembled(ordered).mesh), 15);
    EXPECT_THAT(find_array(ordered, kGhostArray, true, 1)->values, ElementsAre(0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0))
        << "none in the pieces without the array";
}

TEST(JoinPieces, CellsOfOtherKindsAndCurvedOnesAreRenumbered) {
    MeshFile left = slab(0, 1), right;
    right.points = {{5, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, 1}, {2, 0, 0}, {2, 1, 0}, {2, 0, 1}, {1.5, 0.5, -1}};
    right.tets.corners = {{1, 2, 3, 4}};
    right.prisms.corners = {{1, 2, 3, 4, 5, 6}};
    right.pyramids.corners = {{1, 4, 5, 2, 7}};
    right.tets.numbers = {2};
    right.prisms.numbers = {0};
    right.pyramids.numbers = {1};
    right.curved.add(1, CurvedOrder::Exodus, std::vector<Index>{7, 2});
    right.cut = true;
    const MeshFile whole = joined({left, right});
    const auto places = [&](const auto& corners, const MeshFile& file) {
        std::vector<std::array<double, 3>> all;
        for (const Index p : corners) all.push_back({file.points[p].x, file.points[p].y, file.points[p].z});
        return all;
    };
    EXPECT_EQ(places(whole.tets.corners[0], whole), places(right.tets.corners[0], right));
    EXPECT_EQ(places(whole.prisms.corners[0], whole), places(right.prisms.corners[0], right));
    EXPECT_EQ(places(whole.pyramids.corners[0], whole), places(right.pyramids.corners[0], right));
    EXPECT_EQ(places(whole.curved.nodes_of(0), whole), places(right.curved.nodes_of(0), right));
    EXPECT_EQ(whole.tets.numbers[0], 4U + 2) << "after the four cells of the first piece";
    EXPECT_EQ(whole.prisms.numbers[0], 4U);
    EXPECT_EQ(whole.pyramids.numbers[0], 5U);
    EXPECT_EQ(whole.curved.numbers[0], 5U);
    EXPECT_TRUE(whole.cut);
}

TEST(JoinPieces, PartsOfTheSameNameBecomeOne) {
    std::vector<MeshFile> pieces = pieces_of_box();
    for (std::size_t k = 0; k < 3; ++k) {
        FilePatch bottom{.name = "bottom", .role = PatchRole::Wall};
        for (const auto& cell : pieces[k].hexes.corners) {
            if (pieces[k].points[cell[0]].z == 0) bottom.add(std::array{cell[0], cell[3], cell[2], cell[1]});
        }
        pieces[k].patches = {{.name = "other"}, bottom};
        pieces[k].sets = {{"all", pieces[k].hexes.numbers}};
        pieces[k].blocks = {{"block " + std::to_string(k % 2), pieces[k].hexes.corners.size()}};
        FileOnPatch values{.patch = 1};
        for (std::size_t f = 0; f < bottom.size(); ++f)
            values.values.push_back(10. * static_cast<double>(k) + static_cast<double>(f));
        if (k != 1) pieces[k].arrays.back().on_patches = {values};
    }
    const MeshFile whole = joined(pieces);
    ASSERT_EQ(whole.patches.size(), 2U);
    EXPECT_EQ(whole.patches[1].role, PatchRole::Wall);
    double area = 0;
    for (std::size_t f = 0; f < whole.patches[1].size(); ++f) {
        const auto face = whole.patches[1].face(f);
        const auto& x = whole.points;
        area += glm::length(glm::cross(x[face[1]] - x[face[0]], x[face[3]] - x[face[0]]));
        for (const Index p : face) EXPECT_EQ(x[p].z, 0);
    }
    EXPECT_EQ(area, 8);
    const auto& on = find_array(whole, "c", true, 1)->on_patches;
    ASSERT_EQ(on.size(), 1U);
    EXPECT_EQ(on[0].patch, 1U);
    EXPECT_THAT(on[0].values, ElementsAre(0, 1, 2, 3, testing::IsNan(), testing::IsNan(), 20, 21));
    const auto set = [&](const std::string& name) { return std::ranges::find(whole.sets, name, &FileSet::name)->numbers; };
    EXPECT_EQ(set("all").size(), 16U);
    EXPECT_THAT(set("block 1"), ElementsAre(8, 9, 10, 11)) << "the cells of the second piece";
    EXPECT_EQ(set("block 0").size(), 12U);
    ASSERT_EQ(whole.blocks.size(), 3U);
}

TEST(JoinPieces, ArraysThatAPieceLacksHaveGaps) {
    std::vector<MeshFile> pieces = pieces_of_box();
    add_at_points(pieces[0], "p", [](const Vec3& x) { return 2 * x.x - x.z; });
    add_at_cells(pieces[1], "f", {1, 2, 3, 4});  // at the cells: not the one at the points
    pieces[2].arrays[1].components = 2;
    pieces[2].arrays[1].values.resize(8);
    pieces[0].warnings = pieces[1].warnings = {"said once"};
    pieces[0].unread = pieces[2].unread = {{"v", "why"}};
    const std::vector<Vec3> of_first = pieces[0].points;
    const MeshFile whole = joined(pieces);
    const FileArray* const at_points = find_array(whole, "p", false, 1);
    ASSERT_NE(at_points, nullptr);
    for (std::size_t p = 0; p < whole.points.size(); ++p) {
        const Vec3& x = whole.points[p];
        const double value = at_points->values[p];
        if (std::ranges::find(of_first, x) != of_first.end()) {
            EXPECT_EQ(value, 2 * x.x - x.z);
        } else {
            EXPECT_TRUE(std::isnan(value));
        }
    }
    const FileArray* const at_cells = find_array(whole, "f", true, 1);
    ASSERT_NE(at_cells, nullptr);
    EXPECT_EQ(std::ranges::count_if(at_cells->values, [](double value) { return std::isnan(value); }), 12);
    EXPECT_THAT(std::vector(at_cells->values.begin() + 8, at_cells->values.begin() + 12), ElementsAre(1, 2, 3, 4));
    EXPECT_EQ(find_array(whole, "c", true, 1)->values.size(), 16U) << "that of the third piece has two components";
    EXPECT_EQ(find_array(whole, "f", false, 1)->values.size(), 45U);
    EXPECT_EQ(std::ranges::count(whole.warnings, "said once"), 1);
    EXPECT_EQ(whole.unread.size(), 1U);
}

// A layer of cells between two pieces has a value at each of its points, but it is not one of its own.
TEST(JoinPieces, CellsBetweenThoseOfAnArrayDoNotHaveIt) {
    std::vector<MeshFile> pieces;
    for (int k = 0; k < 3; ++k) {
        HexMesh box = make_box(1, 1, 1);
        for (Vec3& x : box.points) x.x += k;
        MeshFile& piece = pieces.emplace_back(file_of(box));
        add_at_points(piece, "x", [](const Vec3& x) { return x.x; });
        if (k != 1) add_at_points(piece, "T", [](const Vec3& x) { return 10 * x.x; });
        if (k != 1) add_at_cells(piece, "at cells", {7});
    }
    const MeshFile whole = joined(pieces);
    EXPECT_EQ(find_array(whole, "T", false, 1), nullptr);
    EXPECT_THAT(whole.warnings,
                Contains("array \"T\" ignored: it is not in every piece, and cells without it lie between those that have it"));
    ASSERT_EQ(whole.ignored.size(), 1U);
    EXPECT_THAT(find_array(whole, "at cells", true, 1)->values, ElementsAre(7, testing::IsNan(), 7));
}

TEST(JoinPieces, CellsAreCountedByAllThatNumbersThem) {
    MeshFile piece = slab(0, 1);
    EXPECT_EQ(cell_count(piece), 4U);
    add_at_cells(piece, "longer", std::vector<double>(6));  // two cells that were left out
    EXPECT_EQ(cell_count(piece), 6U);
    piece.arrays.clear();
    piece.hexes.numbers.back() = 8;
    EXPECT_EQ(cell_count(piece), 9U);
    EXPECT_EQ(cell_count(MeshFile{}), 0U);
    EXPECT_DOUBLE_EQ(largest_cell(slab(0, 3)), std::sqrt(3));
    EXPECT_EQ(largest_cell(MeshFile{}), 0);
}

}  // namespace join_pieces_test
}  // namespace subvol::detail
