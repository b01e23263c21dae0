// SPDX-License-Identifier: Apache-2.0
// Patches and sets of cells in files of VTK, and arrays there that are wrong.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "lib/test_meshes.h"
#include "mesh_files.h"
#include "subvol/mesh_sets.h"
#include "subvol/vtk_grid.h"
#include "vtu_texts.h"

namespace subvol::test {

namespace mesh_arrays_test {

using testing::ElementsAre;
using testing::HasSubstr;

using Numbers = std::vector<std::int64_t>;

// A bar of three cells along x, and its ends.
const HexMesh kBar = make_box(3, 1, 1);

MeshSets sets_of_bar() {
    return {{{"in", {{0, 0}}}, {"a/b & <c>", {{2, 1}, {2, 3}, {1, 3}}}, {"none", {}}},
            {{"ends", {0, 2}}, {"a/b", {1}}, {"empty", {}}}};
}

std::vector<std::pair<std::string, std::vector<std::pair<Index, int>>>> sides_of(const MeshSets& sets) {
    std::vector<std::pair<std::string, std::vector<std::pair<Index, int>>>> all;
    for (const Patch& patch : sets.patches) {
        auto& [name, sides] = all.emplace_back();
        name = patch.name;
        for (const CellSide& side : patch.sides) sides.emplace_back(side.cell, int{side.side});
        std::ranges::sort(sides);
    }
    return all;
}

std::vector<std::pair<std::string, std::vector<Index>>> cells_of(const MeshSets& sets) {
    std::vector<std::pair<std::string, std::vector<Index>>> all;
    for (const CellSet& set : sets.sets) all.emplace_back(set.name, set.cells);
    return all;
}

void expect_kept(const MeshSets& sets) {
    EXPECT_THAT(sides_of(sets),
                ElementsAre(std::pair(std::string("in"), std::vector<std::pair<Index, int>>{{0, 0}}),
                            std::pair(std::string("a/b & <c>"), std::vector<std::pair<Index, int>>{{1, 3}, {2, 1}, {2, 3}})));
    EXPECT_THAT(cells_of(sets), ElementsAre(std::pair(std::string("ends"), std::vector<Index>{0, 2}),
                                            std::pair(std::string("a/b"), std::vector<Index>{1})));
}

class MeshArrays : public MeshFiles {
protected:
    /// The bar as a file with a field array: what is read, with all warnings.
    [[nodiscard]] ReadResult with_field(const std::string& type, const std::string& name, const std::vector<double>& numbers,
                                        const HexMesh& mesh = kBar) const {
        VtuText vtu;
        std::string text = vtu.file(vtu.piece(mesh, ""));
        const std::string array = vtu.array(type, "Name=\"" + name + "\"", numbers);
        return read("a.vtu", text.insert(text.find("<Piece"), "<FieldData>" + array + "</FieldData>"));
    }

    /// The numbers that the bar's own arrays begin with.
    [[nodiscard]] static Numbers mark(const HexMesh& mesh = kBar) {
        Numbers numbers = vtk_field_arrays(mesh, {{{"in", {{0, 0}}}}, {}}).at(0).numbers;
        numbers.resize(numbers.size() - 4);
        return numbers;
    }

    [[nodiscard]] ReadResult with_patch(const Numbers& points) const {
        VtuText vtu;
        std::string text = vtu.file(vtu.piece(kBar, ""));
        Numbers numbers = mark();
        numbers.insert(numbers.end(), points.begin(), points.end());
        const std::string array = vtu.array("Int64", "Name=\"patch:p\"", numbers);
        return read("a.vtu", text.insert(text.find("<Piece"), "<FieldData>" + array + "</FieldData>"));
    }
};

TEST_F(MeshArrays, AreReadAsTheyWereWritten) {
    EXPECT_THAT(write_mesh(path("a.vtu"), kBar, {}, sets_of_bar()), ElementsAre());
    const ReadResult read = read_mesh(path("a.vtu"));
    EXPECT_THAT(read.warnings, ElementsAre());
    EXPECT_EQ(read.mesh.cells, kBar.cells);
    EXPECT_TRUE(read.mesh.attributes.empty() && read.fields.empty());  // a set is no field
    expect_kept(read.sets);
    EXPECT_THAT(write_mesh(path("a.mesh"), kBar, {}, sets_of_bar()),
                ElementsAre(HasSubstr("3 patches (in, a/b & <c>, none) and 3 sets of cells (ends, a/b, empty) not written")));
    EXPECT_TRUE(read_mesh(path("a.mesh")).sets.empty());
}

// Cells of sets are those of the volume: shells come after them.
TEST_F(MeshArrays, StandBesideShells) {
    HexMesh with = kBar;
    const auto corner = static_cast<Index>(with.points.size());
    with.points.insert(with.points.end(), {{0, 0, -1}, {1, 0, -1}});
    const Shells shells = make_shells(with, {{{0, 1, corner + 1, corner}}}, {});
    ASSERT_EQ(shells.quads.size(), 1u);
    write_mesh(path("a.vtu"), kBar, shells, sets_of_bar());
    const ReadResult read = read_mesh(path("a.vtu"));
    EXPECT_EQ(read.shells.quads.size(), 1u);
    expect_kept(read.sets);
}

TEST_F(MeshArrays, OfSidesAndCellsThatDoNotExistAreNotWritten) {
    const auto refused = [&](const MeshSets& sets) { return error_of([&] { write_mesh(path("a.vtu"), kBar, {}, sets); }); };
    EXPECT_THAT(refused({{{"p", {{3, 0}}}}, {}}), HasSubstr("patch \"p\" has a side of cell 3 (less than 3)"));
    EXPECT_THAT(refused({{{"p", {{0, 6}}}}, {}}), HasSubstr("patch \"p\" has side 6"));
    EXPECT_THAT(refused({{}, {{"s", {7}}}}), HasSubstr("set \"s\" has cell 7"));
}

// What other programs write: any numbers at cells. Programs that drop cells take them along.
TEST_F(MeshArrays, OfOtherProgramsAreSets) {
    VtuText vtu;
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const std::string data =
        "<CellData>" + vtu.array("Float64", "Name=\"set:hot\"", std::vector<double>{0, -2.5, 0}) +
        vtu.array("Int8", "Name=\"set:all\"", std::vector<std::int64_t>{1, 1, 1}) +
        vtu.array("Int8", "Name=\"set:nowhere\"", std::vector<std::int64_t>{0, 0, 0}) +
        vtu.array("Int8", "Name=\"set:\"", std::vector<std::int64_t>{1, 0, 0}) +
        vtu.array("Int8", "Name=\"set:pairs\" NumberOfComponents=\"2\"", std::vector<std::int64_t>{1, 0, 0, 0, 0, 0}) +
        "</CellData>";
    const ReadResult read = this->read("a.vtu", vtu.file(vtu.piece(kBar, data)));
    EXPECT_THAT(cells_of(read.sets), ElementsAre(std::pair(std::string("hot"), std::vector<Index>{1}),
                                                 std::pair(std::string("all"), std::vector<Index>{0, 1, 2})));
    ASSERT_EQ(read.fields.size(), 2u);
    EXPECT_EQ(read.fields[0].name, "set:");
    EXPECT_EQ(read.fields[1].name, "set:pairs");
    const std::string gaps =
        "<CellData>" + vtu.array("Float64", "Name=\"set:a\"", std::vector<double>{nan, infinity, 0}) + "</CellData>";
    EXPECT_THAT(cells_of(this->read("a.vtu", vtu.file(vtu.piece(kBar, gaps))).sets),
                ElementsAre(std::pair(std::string("a"), std::vector<Index>{1})));
    EXPECT_THAT(read_error("a.vtu", vtu.file(vtu.piece(
                                        kBar, "<CellData>" + vtu.array("Int8", "Name=\"set:a\"", Numbers{1}) + "</CellData>"))),
                HasSubstr("3 are needed: 1 a cell"));
    const std::string legacy = vtk_text(kBar) + "CELL_DATA 3\nSCALARS set:two int 1\nLOOKUP_TABLE default\n0 1 1\n";
    EXPECT_THAT(cells_of(this->read("a.vtk", legacy).sets),
                ElementsAre(std::pair(std::string("two"), std::vector<Index>{1, 2})));
}

// A piece may lack a set.
TEST_F(MeshArrays, OfPiecesAreJoined) {
    VtuText vtu;
    const auto piece = [&](const std::string& arrays) { return vtu.piece(kBar, "<CellData>" + arrays + "</CellData>"); };
    const auto set = [&](const std::string& name, const Numbers& in) {
        return vtu.array("UInt8", "Name=\"set:" + name + "\"", in);
    };
    const ReadResult read =
        this->read("a.vtu", vtu.file(piece(set("a", {1, 0, 0}) + set("b", {0, 1, 0})) + piece(set("a", {0, 0, 1}))));
    EXPECT_THAT(cells_of(read.sets), ElementsAre(std::pair(std::string("a"), std::vector<Index>{0, 5}),
                                                 std::pair(std::string("b"), std::vector<Index>{1})));
}

// A cell of another kind is split, and its parts are in the set.
TEST_F(MeshArrays, OfSplitCellsHaveTheirParts) {
    VtkUnstructuredGrid grid;
    grid.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    grid.types = {10, 10};
    grid.ends = {4, 8};
    grid.connectivity = {0, 1, 2, 3, 1, 2, 3, 4};
    grid.arrays = {{"set:one", 1, true, {0, 1}}};
    const ReadResult read = mesh_of_vtk(grid);
    ASSERT_EQ(read.mesh.cells.size(), 8u);
    EXPECT_THAT(cells_of(read.sets), ElementsAre(std::pair(std::string("one"), std::vector<Index>{4, 5, 6, 7})));
}

TEST_F(MeshArrays, OfAnotherMeshAreIgnored) {
    write_mesh(path("a.vtu"), kBar, {}, sets_of_bar());
    std::string text = read_bytes(path("a.vtu"));
    const std::size_t at = text.find("<FieldData>"), end = text.find("</FieldData>");
    const std::string list = text.substr(at, end - at) + "</FieldData>";
    HexMesh less = kBar;
    less.cells.pop_back();
    write_mesh(path("less.vtu"), less);
    text = read_bytes(path("less.vtu"));
    text.insert(text.find("<Piece"), list);
    const ReadResult read = this->read("less.vtu", text);
    EXPECT_TRUE(read.sets.empty());
    EXPECT_THAT(read.warnings, ElementsAre("2 patches left out (\"in\", \"a/b & <c>\"): it is of another mesh"));
}

TEST_F(MeshArrays, ThatAreWrongAreIgnoredWithASentence) {
    const auto said = [&](const Numbers& points) {
        const ReadResult read = with_patch(points);
        EXPECT_TRUE(read.sets.empty());
        EXPECT_EQ(read.mesh.cells, kBar.cells);
        EXPECT_EQ(read.warnings.size(), 1u);
        return read.warnings.empty() ? "" : read.warnings[0];
    };
    const auto& c = kBar.cells[0];
    EXPECT_THAT(with_patch({c[0], c[3], c[7], c[4]}).warnings,
                ElementsAre());  // so that the others are wrong for their reasons
    EXPECT_EQ(with_patch({c[0], c[3], c[7], c[4]}).sets.patches.size(), 1u);
    EXPECT_THAT(said({c[0], c[3], c[7]}), HasSubstr("patch \"p\" left out: it has the wrong length"));
    EXPECT_THAT(said({c[0], c[3], c[7], 16}), HasSubstr("it names a point that does not exist"));
    EXPECT_THAT(said({c[0], c[3], c[7], -1}), HasSubstr("it names a point that does not exist"));
    EXPECT_THAT(said({c[0], c[3], c[7], std::numeric_limits<std::int64_t>::max()}), HasSubstr("point that does not exist"));
    EXPECT_THAT(said({c[0], c[3], c[7], c[5]}), HasSubstr("four of its points are not those of a face of a cell"));
    EXPECT_THAT(said({c[0], c[0], c[0], c[0]}), HasSubstr("four of its points are not those of a face of a cell"));
    EXPECT_THAT(said({c[1], c[2], c[6], c[5]}), HasSubstr("its faces lie between cells"));
    EXPECT_THAT(with_field("Int64", "patch:p", {}).warnings, ElementsAre(HasSubstr("it is of another mesh")));
    EXPECT_THAT(with_field("Int64", "patch:p", {16, 3, 5, 0, 1, 2, 3}).warnings, ElementsAre(HasSubstr("another mesh")));
    EXPECT_THAT(with_field("Float64", "patch:p", {1, 2}).warnings,
                ElementsAre("array \"patch:p\" left out: its numbers are not integers"));
    EXPECT_THAT(with_field("String", "patch:p", {1, 2}).warnings, ElementsAre(HasSubstr("left out")));
    EXPECT_THAT(with_field("Float64", "SubvolSharp", {1, 2}).warnings, ElementsAre(HasSubstr("not integers")));
    EXPECT_THAT(with_field("Float64", "patch:", {1, 2}).warnings, ElementsAre());  // of another program
}

TEST_F(MeshArrays, AFaceThatIsThereTwiceCountsOnce) {
    const auto& c = kBar.cells[0];
    const ReadResult read = with_patch({c[0], c[3], c[7], c[4], c[4], c[0], c[3], c[7]});
    EXPECT_THAT(read.warnings, ElementsAre());
    EXPECT_THAT(sides_of(read.sets), ElementsAre(std::pair(std::string("p"), std::vector<std::pair<Index, int>>{{0, 0}})));
}

TEST_F(MeshArrays, AreInGridsOfVtk) {
    VtkUnstructuredGrid grid;
    grid.points = kBar.points;
    grid.types.assign(3, 12);
    for (const auto& cell : kBar.cells) {
        grid.connectivity.insert(grid.connectivity.end(), cell.begin(), cell.end());
        grid.ends.push_back(static_cast<std::int64_t>(grid.connectivity.size()));
    }
    grid.field_arrays = vtk_field_arrays(kBar, sets_of_bar());
    for (const VtkFieldArray& array : grid.field_arrays) EXPECT_TRUE(is_vtk_field_array(array.name));
    EXPECT_FALSE(is_vtk_field_array("TimeValue"));
    grid.field_arrays.push_back({"TimeValue", {1}});
    grid.arrays = {{vtk_set_array({"ends", {}}), 1, true, {1, 0, 1}}, {vtk_set_array({"a/b", {}}), 1, true, {0, 1, 0}}};
    const ReadResult read = mesh_of_vtk(grid);
    EXPECT_THAT(read.warnings, ElementsAre());
    expect_kept(read.sets);
}

}  // namespace mesh_arrays_test

}  // namespace subvol::test
