// SPDX-License-Identifier: Apache-2.0
// Abaqus and CalculiX decks.

#include <gmock/gmock.h>

#include <cmath>

#include "lib/temp_folder.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace abaqus_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

// Two unit cubes beside each other, whose nodes have numbers with gaps.
constexpr const char* kNodes =
    "*Node, NSET=all\n"
    " 10, 0, 0, 0\n 20, 1., 0, 0\n 30, 1.D0, 1, 0\n 40, 0, 1, 0\n50,,,1\n60,1,,1\n70,1,1,1\n80,0,1,1\n"
    "** a comment\n 90, 2, 0, 0\n 100, 2, 1\n 110, 2, 0, 1\n 120, 2, 1, 1\n";

class Abaqus : public TempFolder {
protected:
    [[nodiscard]] std::string error(const std::string& text) const {
        return error_of([&] { static_cast<void>(read_mesh(write("a.inp", text))); });
    }
};

TEST_F(Abaqus, NodesElementsAndSets) {
    const std::string text = std::string("*HEADING\n anything, 1, 2\n") + kNodes +
                             "*ELEMENT, TYPE=C3D8R, ELSET=left\n1, 10, 20, 30, 40, 50, 60, 70, 80\n"
                             "*element, type = c3d8I\n7, 20, 90, 100, 30, 60,\n 110, 120, 70\n"
                             "*ELEMENT, TYPE=S4R, ELSET=skin\n9, 10, 20, 30, 40\n"
                             "*ELSET, ELSET=right\n7\n*ELSET, ELSET=both\nleft, right\n*ELSET, ELSET=every, GENERATE\n1, 7, 6\n"
                             "*STEP\n*NODE PRINT\nU\n*END STEP\n";
    const ReadResult result = read_mesh(write("a.inp", text));
    EXPECT_NEAR(inspect(result.mesh).volume, 2, 1e-12);
    EXPECT_EQ(inspect(result.mesh).interior_edges, 0u);
    EXPECT_EQ(inspect(result.mesh).faces, 11u);
    EXPECT_THAT(result.warnings, ElementsAre("1 element of type S4R ignored"));
    std::vector<std::string> blocks;
    for (const MeshBlock& block : result.blocks) blocks.push_back(block.name + " " + std::to_string(block.cells));
    EXPECT_THAT(blocks, ElementsAre("both 2", "every 2", "left 1", "right 1"));
    EXPECT_EQ(read_mesh(path("a.inp"), {.blocks = {"right"}}).mesh.cells.size(), 1u);
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("a.inp"), {.blocks = {"x"}})); }),
                HasSubstr("a.inp: there is no block \"x\" (it has: both, every, left, right, skin)"));
}

TEST_F(Abaqus, ShellsAndBeamsAreSheetsAndCurves) {
    // A fin of two shells on the edge 50-60 of a cube, a rod at its end, a face of the cube, and shells of three nodes.
    const std::string cube = std::string(kNodes) + "*ELEMENT, TYPE=C3D8\n1, 10, 20, 30, 40, 50, 60, 70, 80\n";
    const std::string nodes = "*NODE\n200, 0, 0, 2\n210, 1, 0, 2\n220, 0, 0, 3\n230, 1, 0, 3\n240, 3, 0, 3\n";
    const std::string sheets =
        "*ELEMENT, TYPE=S4R5, ELSET=fin\n2, 50, 60, 210, 200\n3, 200, 210, 230, 220\n"
        "*ELEMENT, TYPE=B31\n4, 230, 240\n*ELEMENT, TYPE=M3D4R\n5, 10, 20, 30, 40\n"
        "*ELEMENT, TYPE=S3\n6, 50, 60, 200\n*ELEMENT, TYPE=SAX1\n7, 220, 230\n";
    const ReadResult found = read_mesh(write("a.inp", cube + nodes + sheets));
    EXPECT_THAT(found.shells.quads, ElementsAre(std::array<Index, 4>{0, 1, 3, 2}, std::array<Index, 4>{2, 3, 5, 4}));
    EXPECT_THAT(found.shells.lines, ElementsAre(std::array<Index, 2>{5, 6}));
    ASSERT_EQ(found.shells.points.size(), 7u);
    EXPECT_EQ(found.shells.points[6], Vec3(3, 0, 3));
    EXPECT_EQ(found.shells.solid[0], (CellCorner{0, 4}));
    EXPECT_EQ(found.shells.solid[2].cell, kNone);
    EXPECT_THAT(found.warnings, ElementsAre("1 element of type M3D4R, 1 element of type S3, 1 element of type SAX1 ignored"));
    EXPECT_EQ(found.mesh.cells.size(), 1u);
    const ReadResult fin = read_mesh(path("a.inp"), {.blocks = {"fin"}, .shells_alone = true});
    EXPECT_EQ(fin.shells.quads.size(), 2u);
    EXPECT_EQ(fin.mesh.cells.size(), 0u);
    EXPECT_THAT(error(cube + nodes + "*ELEMENT, TYPE=S4\n2, 50, 60, 210\n"), HasSubstr("S4"));
    EXPECT_THAT(error(cube + nodes + "*ELEMENT, TYPE=S4\n2, 50, 60, 210, 999\n"), HasSubstr("there is no node 999"));
}

TEST_F(Abaqus, InstancesArePlacedAndFilesIncluded) {
    write("nodes.inp", kNodes);
    const ReadResult result =
        read_mesh(write("a.inp",
                        "*PART, NAME=cube\n*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=C3D8\n1, 10, 20, 30, 40, 50, 60, 70, 80\n"
                        "*END PART\n*ASSEMBLY, NAME=a\n*INSTANCE, NAME=i, PART=Cube\n*END INSTANCE\n"
                        "*INSTANCE, NAME=j, PART=cube\n5, 0, 0\n5, 0, 0, 5, 0, 1, 90\n*END INSTANCE\n*END ASSEMBLY\n"));
    const MeshReport report = inspect(result.mesh);
    EXPECT_EQ(report.cells, 2u);
    EXPECT_NEAR(report.volume, 2, 1e-12);
    // Moved to x from 5 to 6, then turned by 90° about x = 5, y = 0: x from 4 to 5.
    EXPECT_NEAR(report.bounds.upper.x, 5, 1e-12);
    EXPECT_NEAR(report.bounds.lower.x, 0, 1e-12);
}

// Coreform's and others' files.
TEST_F(Abaqus, PartsWithoutInstancesAreWhereTheirNodesAre) {
    write("nodes.inp", kNodes);
    const std::string part =
        "*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=C3D8, ELSET=all\n1, 10, 20, 30, 40, 50, 60, 70, 80\n*END PART\n";
    const ReadResult one = read_mesh(write("a.inp", "*PART, NAME=cube\n" + part));
    EXPECT_NEAR(inspect(one.mesh).volume, 1, 1e-12);
    EXPECT_THAT(one.warnings, Contains("1 part has no *INSTANCE: taken where the nodes are"));
    EXPECT_EQ(read_mesh(write("b.inp", "*PART, NAME=a\n" + part + "*PART, NAME=b\n" + part)).mesh.cells.size(), 2U);
    EXPECT_THAT(error("*PART, NAME=a\n*END PART\n"), HasSubstr("it has no nodes"));
}

TEST_F(Abaqus, CurvedHexahedraHaveTheirShape) {
    // A cube whose edge 1–2 bulges out to y = -0.1: its parabola adds 2/3 · 0.1 at one edge of one face.
    std::string text = "*NODE\n";
    const std::vector<std::array<int, 2>> edges{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                                {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    std::vector<Vec3> nodes = corners;
    for (const auto& [a, b] : edges)
        nodes.push_back(.5 * (corners[static_cast<std::size_t>(a)] + corners[static_cast<std::size_t>(b)]));
    nodes[8].y = -.1;
    std::string element = "1";
    for (std::size_t p = 0; p < nodes.size(); ++p) {
        text += std::to_string(p + 1) + "," + std::to_string(nodes[p].x) + "," + std::to_string(nodes[p].y) + "," +
                std::to_string(nodes[p].z) + "\n";
        element += "," + std::string(p % 10 == 9 ? "\n" : "") + std::to_string(p + 1);
    }
    const ReadResult result = read_mesh(write("a.inp", text + "*ELEMENT, TYPE=C3D20R\n" + element + "\n"));
    // The edge's displacement 0.4 x (1 - x) falls linearly to the opposite edges: its mean over the face is half of 1/15.
    EXPECT_NEAR(inspect(result.mesh).volume, 1 + .1 * 2 / 3 / 2, 1e-4);
    EXPECT_GT(result.mesh.cells.size(), 1u);
}

// 3 × 2 × 2 cubes of one element and the corners of the box.
TEST_F(Abaqus, NodesAndElementsAreGenerated) {
    std::string text = "*NODE\n";
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j) {
            for (const int i : {0, 3}) {
                text += std::to_string(100 * k + 10 * j + i + 1) + "," + std::to_string(i) + "," + std::to_string(j) + "," +
                        std::to_string(k) + "\n";
            }
        }
    }
    text += "*NGEN, NSET=ALL\n";
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j) {
            const int first = 100 * k + 10 * j + 1;
            text += std::to_string(first) + "," + std::to_string(first + 3) + (j == 1 ? "\n" : ",1\n");
        }
    }
    const std::string element = "*ELEMENT, TYPE=C3D8\n1, 1,2,12,11,101,102,112,111\n";
    const ReadResult result = read_mesh(write("a.inp", text + element + "*ELGEN, ELSET=BODY\n1, 3,1,1, 2,10,10, 2,100,100\n"));
    EXPECT_EQ(result.mesh.cells.size(), 12u);
    EXPECT_EQ(result.mesh.points.size(), 36u);
    EXPECT_NEAR(inspect(result.mesh).volume, 12, 1e-12);
    ASSERT_EQ(result.blocks.size(), 1u);
    EXPECT_EQ(result.blocks[0].cells, 12u);
    EXPECT_THAT(error(text + "*NGEN\n1, 5\n"), HasSubstr("there is no node 5"));
    EXPECT_THAT(error(text + "*NGEN\n1, 4, 2\n"), HasSubstr("the numbers from 1 to 4 are not in steps of 2"));
    EXPECT_THAT(error(text + "*NODE\n2000000001, 1\n*NGEN\n1, 2000000001\n"),
                HasSubstr("too many nodes or elements are generated"));
    EXPECT_THAT(error(text + "*NGEN, LINE=C\n1, 4\n"), HasSubstr("nodes on curves (*NGEN, LINE) are not supported"));
    EXPECT_THAT(error(text + element + "*ELGEN\n2, 3\n"), HasSubstr("there is no element 2"));
    EXPECT_THAT(error(text + element + "*ELGEN\n1, 9000, 1, 1, 9000\n"), HasSubstr("too many nodes or elements are generated"));
}

// A cube of the eight corners of a box in some coordinates: from a1 to a2, b1 to b2, c1 to c2.
std::string box(std::array<double, 2> a, std::array<double, 2> b, std::array<double, 2> c) {
    std::string text;
    for (int p = 0; p < 8; ++p) {
        const std::array<int, 4> x{0, 1, 1, 0}, y{0, 0, 1, 1};
        const auto i = static_cast<std::size_t>(p % 4);
        text += std::to_string(p + 1) + "," + std::to_string(a[static_cast<std::size_t>(x[i])]) + "," +
                std::to_string(b[static_cast<std::size_t>(y[i])]) + "," + std::to_string(c[p < 4 ? 0 : 1]) + "\n";
    }
    return text;
}

constexpr const char* kElement = "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1,2,3,4,5,6,7,8\n";

TEST_F(Abaqus, NodesAreInTheirSystems) {
    // Radius 1 to 2, angles of 0° to 90°, height 3: two straight sides and two chords.
    const auto points = [&](const std::string& text) { return read_mesh(write("a.inp", text + kElement)).mesh.points; };
    const auto near = [](const Vec3& a, const Vec3& b) { return glm::distance(a, b) < 1e-12; };
    const auto round = points("*NODE, NSET=ALL, SYSTEM=C\n" + box({1, 2}, {0, 90}, {0, 3}));
    EXPECT_PRED2(near, round[2], Vec3(0, 2, 0));
    EXPECT_PRED2(near, round[7], Vec3(0, 1, 3));
    // The second angle of a sphere is that above the plane of x and y.
    const auto sphere = points("*NODE, SYSTEM=SPHERICAL\n" + box({1, 2}, {0, 90}, {0, 30}));
    EXPECT_PRED2(near, sphere[6], Vec3(0, std::sqrt(3), 1));
    // The axes of a *SYSTEM: x' along y, y' along z, so z' along x; until the next one without data.
    const std::string system = "*SYSTEM\n10, 0, 0, 10, 5, 0\n10, 0, 5\n";
    const auto moved = points(system + "*NODE\n" + box({0, 1}, {0, 2}, {0, 3}));
    EXPECT_PRED2(near, moved[6], Vec3(13, 1, 2));
    EXPECT_PRED2(near, points(system + "*SYSTEM\n*NODE\n" + box({0, 1}, {0, 2}, {0, 3}))[6], Vec3(1, 2, 3));
    EXPECT_PRED2(near, points("*SYSTEM\n1,1,1\n*NODE\n" + box({0, 1}, {0, 2}, {0, 3}))[6], Vec3(2, 3, 4));
    // Without the second line they turn about z: both systems at once.
    const auto turned = points("*SYSTEM\n0,0,5, 0,1,7\n*NODE, SYSTEM=C\n" + box({1, 2}, {0, 90}, {0, 3}));
    EXPECT_PRED2(near, turned[6], Vec3(-2, 0, 8));
    EXPECT_PRED2(near, turned[1], Vec3(0, 2, 5));
}

TEST_F(Abaqus, ElementsAreTakenByTheirShape) {
    const std::string nodes = "*NODE\n" + box({0, 1}, {0, 1}, {0, 1});
    for (const char* type : {"C3D8RHT", "F3D8", "COH3D8P", "SC8R", "DCC3D8D", "AC3D8R", "CSS8", "EC3D8R", "Q3D8", "GK3D8"}) {
        const ReadResult found = read_mesh(write("a.inp", nodes + "*ELEMENT, TYPE=" + type + "\n1, 1,2,3,4,5,6,7,8\n"));
        EXPECT_NEAR(inspect(found.mesh).volume, 1, 1e-12) << type;
    }
    for (const char* type : {"S8R", "CPE8", "CAX8", "M3D8", "SFM3D8", "CIN3D8", "DS8", "F3D4", "CONN3D2"}) {
        EXPECT_THAT(error(nodes + "*ELEMENT, TYPE=" + type + "\n1, 1,2,3,4,5,6,7,8\n"),
                    HasSubstr("no hexahedra, but 1 element of type " + std::string(type)));
    }
    const ReadResult longer = read_mesh(write("a.inp", nodes + "*ELEMENT, TYPE=C3D8\n1, 1,2,3,4,5,6,7,8, 9, 93,\n"));
    EXPECT_THAT(longer.warnings, ElementsAre("1 element has more numbers than nodes: those after the last node are ignored"));
    // The nodes of other elements may have any form, as connectors of an assembly have.
    const ReadResult mixed = read_mesh(write("a.inp", nodes + kElement + "*ELEMENT, TYPE=CONN3D2\n7, a.1, b.2\n"));
    EXPECT_THAT(mixed.warnings, ElementsAre("1 element of type CONN3D2 ignored"));
}

TEST_F(Abaqus, LinesGoOnAndNamesHaveQuotes) {
    write("some nodes, all.txt", box({0, 1}, {0, 1}, {0, 1}));
    const std::string text =
        "*NODE, NSET=ALL,\n SYSTEM=R, INPUT=\"some nodes, all.txt\"\n* Element, TYPE=C3D8,\n** a comment\n"
        "*ENDPART\n*ELEMENT, TYPE=C3D8,\n ELSET=\"My, set\"\n1, 1,2,3,4,\n5,6,7,8\n";
    const ReadResult found = read_mesh(write("a.inp", text));
    ASSERT_EQ(found.blocks.size(), 1u);
    EXPECT_EQ(found.blocks[0].name, "My, set");
    EXPECT_EQ(read_mesh(path("a.inp"), {.blocks = {"my, SET"}}).mesh.cells.size(), 1u);
}

TEST_F(Abaqus, AssembliesHaveMeshesAndSetsInTheirInstances) {
    const std::string mesh = "*Node\n" + box({0, 1}, {0, 1}, {0, 1}) + kElement;
    // As Abaqus/CAE writes an independent mesh, and one part in two instances with sets of the assembly.
    const std::string text = "*Part, name=A\n*End Part\n*Part, name=B\n" + mesh +
                             "*End Part\n*Assembly, name=x\n*Instance, name=A-1, part=A\n5,0,0\n" + mesh +
                             "*Elset, elset=Inner\n1\n*End Instance\n"
                             "*Instance, name=B-1, part=B\n*End Instance\n*Instance, name=B-2, part=b\n0,5,0\n*End Instance\n"
                             "*Elset, elset=_Surf, internal, instance=B-2, generate\n1, 9000000000, 1\n"
                             "*Elset, elset=Two, instance=A-1\n1\n*ELSET, elset=two, instance=b-1\nE\n"
                             "*Elset, elset=All\nTWO, b-2.1\n*Elset, elset=bad\nnothing\n*Elset, elset=worse, generate\n9, 1\n"
                             "*Node\n1, 9, 9, 9\n*Element, type=MASS\n1, 1\n*End Assembly\n";
    const ReadResult found = read_mesh(write("a.inp", text));
    EXPECT_NEAR(inspect(found.mesh).volume, 3, 1e-12);
    EXPECT_NEAR(inspect(found.mesh).bounds.upper.x, 6, 1e-12);
    std::vector<std::string> blocks;
    for (const MeshBlock& block : found.blocks) blocks.push_back(block.name + " " + std::to_string(block.cells));
    EXPECT_THAT(blocks, ElementsAre("All 3", "E 3", "Inner 1", "Two 2", "_Surf 1"));
    EXPECT_THAT(found.warnings, Contains(HasSubstr("2 sets of elements left out (\"bad\", \"worse\"): ")));
    EXPECT_EQ(read_mesh(path("a.inp"), {.blocks = {"Two"}}).mesh.cells.size(), 2u);
    EXPECT_NEAR(inspect(read_mesh(path("a.inp"), {.blocks = {"_Surf"}}).mesh).bounds.lower.y, 5, 1e-12);
}

TEST_F(Abaqus, WhatNamesNothingIsSaid) {
    const std::string mesh = std::string(kNodes) + "*ELEMENT, TYPE=C3D8, ELSET=all\n1, 10, 20, 30, 40, 50, 60, 70, 80\n";
    const auto warnings = [&](const std::string& more) { return read_mesh(write("a.inp", mesh + more)).warnings; };
    EXPECT_THAT(
        warnings(
            "*ELSET, ELSET=some\n1\n*ELSET, ELSET=range, GENERATE\n1, 5, 1\n*SURFACE, NAME=s\nsome, S1\n*NODE\n30, 1, 1\n"),
        ElementsAre());
    EXPECT_THAT(warnings("*ELSET, ELSET=some\n1, 77, 78\n*ELSET, ELSET=none\n9\n"),
                ElementsAre("numbers in sets of elements that no element has: \"none\" (1), \"some\" (2)"));
    EXPECT_THAT(warnings("*SURFACE, NAME=s\nALL, S1\nnope, S2\n"),
                ElementsAre("its surfaces name sets that it does not have: \"NOPE\""));
    EXPECT_THAT(warnings("*NODE\n30, 1, 1, .5\n"),
                ElementsAre("1 node is listed again with other coordinates: the last ones are taken"));
}

TEST_F(Abaqus, WrongDecksGetASentenceWithTheLine) {
    const std::string nodes = kNodes;
    EXPECT_THAT(error(""), HasSubstr("a.inp: it has no nodes"));
    EXPECT_THAT(error("*NODE\n1, 2, x\n"), HasSubstr("a.inp, line 2: a number is expected, not \"x\""));
    EXPECT_THAT(error("*NODE\nx, 2\n"), HasSubstr("a.inp, line 2: an integer is expected, not \"x\""));
    EXPECT_THAT(error(nodes), HasSubstr("a.inp: no hexahedra"));
    EXPECT_THAT(error(nodes + "*ELEMENT, TYPE=C3D8\n5, 10, 20, 30, 40, 50, 60, 70, 99\n"),
                HasSubstr("a.inp: element 5: there is no node 99"));
    EXPECT_THAT(error(nodes + "*ELEMENT, TYPE=C3D8\n5, 10, 20, 30\n*STEP\n"), HasSubstr("element 5 of type C3D8 has 3 nodes"));
    EXPECT_THAT(error(nodes + "*ELEMENT\n5, 10\n"), HasSubstr("the *ELEMENT has no TYPE"));
    EXPECT_THAT(error("*INCLUDE, INPUT=b.inp\n"), HasSubstr("a.inp, line 1: there is no file \"b.inp\""));
    EXPECT_THAT(error("*INCLUDE, INPUT=a.inp\n"), HasSubstr("a.inp, line 1: names itself, by a.inp > a.inp"));
    EXPECT_THAT(error("*INSTANCE, PART=p\n"), HasSubstr("there is no part \"P\""));
    EXPECT_THAT(error(nodes + "*NCOPY, CHANGE NUMBER=1, OLD SET=a, SHIFT\n1\n"), HasSubstr("makes or moves nodes"));
    EXPECT_THAT(error("*NODE, SYSTEM=X\n1, 2\n"), HasSubstr("line 1: nodes in the system \"X\" are not supported"));
    EXPECT_THAT(error("*SYSTEM\n0,0,0,1,0,0\n2,0,0\n"), HasSubstr("line 3: the points of the *SYSTEM lie on one line"));
    EXPECT_THAT(error("*SYSTEM\n0,0,0,1,0\nx\n"), HasSubstr("line 3: a number is expected"));
}

}  // namespace abaqus_test

}  // namespace subvol::test
