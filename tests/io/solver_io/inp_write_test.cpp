// SPDX-License-Identifier: Apache-2.0
// Decks that are written, beside what the manuals of Abaqus and CalculiX say.

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

namespace inp_write_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class InpWrite : public TempFolder {
protected:
    [[nodiscard]] std::string text_of(const HexMesh& mesh, const MeshSets& sets = {}) {
        warnings_ = write_mesh(path("a.inp"), mesh, {}, sets);
        return read_bytes(path("a.inp"));
    }
    [[nodiscard]] ReadResult again() const { return read_mesh(path("a.inp")); }

    std::vector<std::string> warnings_;
};

// S1 is the side of the nodes 1 to 4, S2 that of 5 to 8, S3 has 1, 2, 6, 5, S4 has 2, 3, 7, 6, S5 has 3, 4, 8, 7, S6 has 4, 1,
// 5, 8. The first corner is at the origin, the second one along x, the fourth along y, the fifth along z.
TEST_F(InpWrite, SidesHaveTheNumbersOfTheManuals) {
    const HexMesh cube = make_box(1, 1, 1);
    const std::array<std::string, 6> sides{"S6", "S4", "S3", "S5", "S1", "S2"};  // at x, y and z of 0 and 1
    for (std::size_t side = 0; side < 6; ++side) {
        const std::string text = text_of(cube, {{{"one", {{0, static_cast<std::uint8_t>(side)}}}}, {}});
        EXPECT_THAT(text, HasSubstr("*SURFACE, NAME=one, TYPE=ELEMENT\n1, " + sides[side] + "\n"));
        const ReadResult read = again();
        ASSERT_EQ(read.sets.patches.size(), 1u);
        EXPECT_EQ(read.sets.patches[0].sides[0].side, side);
        // The points of the patch are a set of nodes, for *BOUNDARY.
        ASSERT_EQ(read.sets.nodes.size(), 1u);
        for (const Index p : points_of(read.mesh, read.sets.nodes[0])) {
            EXPECT_EQ(read.mesh.points[p][static_cast<int>(side / 2)], static_cast<double>(side % 2));
        }
        EXPECT_EQ(points_of(read.mesh, read.sets.nodes[0]).size(), 4u);
    }
}

TEST_F(InpWrite, SetsComeBackAndHaveNamesThatProgramsTake) {
    const HexMesh box = make_box(20, 1, 1);
    MeshSets sets;
    sets.sets = {{"rotor", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}},
                 {"left half", {0, 5}},
                 {"ROTOR", {3}},
                 {"2nd", {19}},
                 {"none", {}}};
    const std::vector<Index> corners{0, 20};
    sets.nodes = {node_set_of(box, "fixed", corners)};
    const std::string text = text_of(box, sets);
    EXPECT_THAT(warnings_,
                ElementsAre("set of cells \"left half\" is called \"left_half\"",
                            "set of cells \"ROTOR\" is called \"ROTOR_2\"", "set of cells \"2nd\" is called \"S_2nd\""));
    const ReadResult read = again();
    std::map<std::string, std::vector<Index>> found;
    for (const CellSet& set : read.sets.sets) found[set.name] = set.cells;
    EXPECT_EQ(found["rotor"], sets.sets[0].cells);
    EXPECT_EQ(found["left_half"], sets.sets[1].cells);
    EXPECT_EQ(found["ROTOR_2"], sets.sets[2].cells);
    EXPECT_EQ(found["Eall"].size(), 20u);
    EXPECT_EQ(found.size(), 5u);
    ASSERT_EQ(read.sets.nodes.size(), 1u);
    EXPECT_EQ(points_of(read.mesh, read.sets.nodes[0]), corners);
    EXPECT_EQ(read.mesh.cells, box.cells);
    // A line has at most 16 numbers.
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(std::ranges::count(line, ','), 15) << line;
    // A set of all elements of one's own stands for it.
    sets.sets = {{"EALL", {1}}};
    EXPECT_THAT(text_of(box, sets), Not(HasSubstr("TYPE=C3D8, ELSET")));
}

// CalculiX reads the first 20 characters of a number: of 1e-5 with all digits it would read no exponent.
TEST_F(InpWrite, NumbersHaveAtMostTwentyCharacters) {
    HexMesh cube = make_box(1, 1, 1);
    const std::array<double, 4> odd{-1.2345678901234567e-5, -9.8765432109876543e-101, 0.1, 1e22 / 3};
    for (std::size_t k = 0; k < odd.size(); ++k) cube.points[k].x = odd[k];
    std::istringstream lines(text_of(cube));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream items(line);
        for (std::string item; line[0] != '*' && std::getline(items, item, ',');) EXPECT_LE(item.size(), 21u) << line;
    }
    const HexMesh read = again().mesh;
    for (std::size_t k = 0; k < odd.size(); ++k) EXPECT_NEAR(read.points[k].x / odd[k], 1, 1e-12) << k;
    EXPECT_EQ(read.points[2].x, 0.1);
}

TEST_F(InpWrite, SaysWhatADeckDoesNotHold) {
    HexMesh cube = make_box(1, 1, 1);
    cube.attributes = {{"Temp", 1, std::vector<double>(8, 1)}};
    cube.creases = {{0, 1}};
    static_cast<void>(text_of(cube));
    EXPECT_THAT(warnings_, ElementsAre(".inp cannot hold attributes: \"Temp\" not written",
                                       "1 crease not written: .inp files do not have them"));
}

}  // namespace inp_write_test

}  // namespace subvol::test
