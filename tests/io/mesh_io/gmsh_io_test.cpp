// SPDX-License-Identifier: Apache-2.0
// Gmsh, version 2, ASCII, and what all versions have in common.

#include <gmock/gmock.h>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "mesh_texts.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace gmsh_io_test {

using testing::ElementsAre;
using testing::HasSubstr;

class GmshIo : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& text) const { return read_mesh(write("a.msh", text)); }
    [[nodiscard]] std::string read_error(const std::string& text) const {
        return error_of([&] { static_cast<void>(read(text)); });
    }
};

const HexMesh kBox = make_box(2, 1, 1);

// Version 1 has no format section; its elements have two tags and the number of their nodes.
TEST_F(GmshIo, Version1) {
    const std::string text =
        "$NOD\n9\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n9 5 5 5\n$ENDNOD\n"
        "$ELM\n2\n1 3 7 1 4 1 2 3 4\n2 5 8 1 8 1 2 3 4 5 6 7 8\n$ENDELM\n";
    const ReadResult result = read(text);
    EXPECT_EQ(result.mesh.cells.size(), 1u);
    EXPECT_NEAR(inspect(result.mesh).volume, 1, 1e-12);
    EXPECT_EQ(read_mesh(write("a.mesh", text)).mesh.cells.size(), 1u);
    EXPECT_THAT(read_error(replaced(text, "1 8 1 2", "1 7 1 2")), HasSubstr("element 2 has another number of nodes"));
    EXPECT_THAT(read_error(replaced(text, "$ENDELM", "$EndELM")), HasSubstr("$ENDELM"));
}

TEST_F(GmshIo, HexahedraWithAndWithoutTags) {
    for (const std::string tags : {"0", "2 1 7", "4 1 7 1 2"}) {
        const ReadResult result = read(gmsh_text(kBox, tags));
        EXPECT_EQ(result.mesh.points, kBox.points);
        EXPECT_EQ(result.mesh.cells, kBox.cells);
        EXPECT_TRUE(result.warnings.empty());
    }
}

TEST_F(GmshIo, NodesMayHaveAnyNumbers) {
    std::string text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"all of it\"\n$EndPhysicalNames\n$Nodes\n8\n";
    const HexMesh cell = make_box(1, 1, 1);
    for (std::size_t p = 8; p-- > 0;) {
        const Vec3 x = cell.points[p];
        text += std::to_string(1000 * (p + 1)) + " " + number(x.x) + " " + number(x.y) + " " + number(x.z) + "\n";
    }
    text += "$EndNodes\n$Elements\n1\n9 5 0 1000 2000 4000 3000 5000 6000 8000 7000\n$EndElements\n";
    const ReadResult result = read(text);
    EXPECT_EQ(result.mesh.cells[0], (std::array<Index, 8>{7, 6, 4, 5, 3, 2, 0, 1}));
    EXPECT_EQ(inspect(result.mesh).volume, 1);
    EXPECT_THAT(read_error(replaced(text, " 8000 7000", " 8000 7001")), HasSubstr("element 1: there is no node 7001"));
    EXPECT_THAT(read_error(replaced(text, "\n7000 ", "\n8000 ")), HasSubstr("there are two nodes 8000"));
}

// Version 2.0 has no dimension before the number, and Elmer's writer no blank before the name.
TEST_F(GmshIo, NamesOfVersion20HaveNoDimension) {
    for (const std::string name : {"7 \"body\"", "7\"body\"", " 3 7 \"body\"", "3 7\"body\"", "7 \"2 bodies\""}) {
        const std::string names = "$EndMeshFormat\n$PhysicalNames\n1\n" + name + "\n$EndPhysicalNames\n";
        const ReadResult result = read(replaced(gmsh_text(kBox, "2 7 1"), "$EndMeshFormat\n", names));
        ASSERT_EQ(result.sets.sets.size(), 1U) << name;
        EXPECT_EQ(result.sets.sets[0].name, name.find("bodies") == std::string::npos ? "body" : "2 bodies");
    }
    const std::string bad = "$EndMeshFormat\n$PhysicalNames\n1\nx7\"body\"\n$EndPhysicalNames\n";
    EXPECT_THAT(read_error(replaced(gmsh_text(kBox, "2 7 1"), "$EndMeshFormat\n", bad)),
                HasSubstr("physical name 1 of 1: an integer is expected, not"));
}

TEST_F(GmshIo, OtherElements) {
    const HexMesh cell = make_box(1, 1, 1);
    const auto with = [&](const std::string& elements, int count) {
        const std::string text =
            replaced(gmsh_text(cell, "0"), "$Elements\n1\n", "$Elements\n" + std::to_string(count + 1) + "\n" + elements);
        return replaced(text, "$Nodes\n8\n", "$Nodes\n10\n9 .5 .5 2\n10 2 .5 2\n");
    };
    EXPECT_THAT(read(with("1 15 2 0 1 3\n2 1 0 1 2\n3 2 0 1 2 3\n4 3 0 1 2 4 3\n5 8 0 1 2 3\n", 5)).warnings,
                ElementsAre("1 line, 1 point, 1 quad, 1 quadratic line, 1 triangle ignored"));
    EXPECT_THAT(read(with("1 7 0 5 6 8 7 9\n2 4 0 6 8 9 10\n", 2)).warnings,
                ElementsAre(HasSubstr("1 hexahedron, 1 tetrahedron and 1 pyramid cut into 9 tetrahedra and split into 36")));
    EXPECT_THAT(read(with("1 6 0 5 6 9 7 8 10\n", 1)).warnings[0], HasSubstr("1 hexahedron and 1 prism split into 14"));
    EXPECT_THAT(read_error(with("1 99 0 1\n", 1)), HasSubstr("element 1 is of the unknown type 99"));
    EXPECT_THAT(read(with("1 4 0 1 2 3 1\n", 1)).warnings, ElementsAre(HasSubstr("1 cell without volume")));
}

TEST_F(GmshIo, SectionsOfOthersMayComeFirst) {
    const std::string text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n"
        "6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n$Elements\n1\n1 5 2 1 1 1 2 3 4 5 6 7 8\n$EndElements\n";
    const std::string others = "$Comments\n$MeshFormat\nby hand\n$EndComments\n$Mine\n1 2 3\n$EndMine\n";
    EXPECT_EQ(read(others + text + "$More\nx\n$EndMore\n").mesh.cells.size(), 1u);
    EXPECT_EQ(read_mesh(write("a.dat", others + text)).mesh.cells.size(), 1u);
    EXPECT_THAT(read_error("$Comments\nno end\n" + text), testing::HasSubstr("not a Gmsh file: it begins with \"$Comments\""));
}

TEST_F(GmshIo, FieldsAtNodes) {
    std::string values, vectors;
    for (int n = 12; n >= 1; --n) {
        values += std::to_string(n) + " " + std::to_string(10 * n) + "\n";
        vectors += std::to_string(n) + " 0 0 -" + std::to_string(n) + "\n";
    }
    const std::string data = "$NodeData\n2\n\"my field\"\n\"scheme\"\n1\n0.5\n3\n0\n1\n12\n" + values + "$EndNodeData\n" +
                             "$NodeData\n1\nv\n0\n4\n0\n3\n12\n0\n" + vectors + "$EndNodeData\n" +
                             "$NodeData\n1\npart\n0\n3\n0\n1\n1\n1 5\n$EndNodeData\n" +
                             "$ElementData\n1\n\"e\"\n0\n3\n0\n1\n1\n1 5\n$EndElementData\n";
    const ReadResult result = read(gmsh_text(kBox, "0") + data);
    EXPECT_EQ(result.mesh.find_attribute("my field")->values[2], 30);
    EXPECT_EQ(result.mesh.find_attribute("v")->channels, 3);
    EXPECT_EQ(result.mesh.find_attribute("v")->values[35], -12);
    EXPECT_THAT(result.warnings, ElementsAre("array \"part\" ignored: it has no value at 11 nodes",
                                             "array \"e\" ignored: it has no value at 1 element"));
    EXPECT_THAT(read_error(gmsh_text(kBox, "0") + replaced(data, "\n12 120\n", "\n5 120\n")),
                HasSubstr("array \"my field\": line 8: node 5 has a value already"));
    EXPECT_THAT(read_error(gmsh_text(kBox, "0") + replaced(data, "1\n0.5\n", "1\nnan\n")),
                HasSubstr("array \"my field\": its time is not finite"));
}

TEST_F(GmshIo, ErrorsNameThePlace) {
    const std::string good = gmsh_text(kBox, "0");
    const std::vector<std::array<std::string, 3>> cases{
        {"2.2 0 8", "3 0 8", "line 2: version 3 of Gmsh's format is not supported (2 and 4 are"},
        {"2.2 0 8", "2.2 1 8", "line 3: the byte order is unknown"},
        {"$EndNodes", "", "$EndNodes is expected, not \"$Elements\""},
        {"$Nodes\n12", "$Nodes\n13", "number of node 13 of 13: an integer is expected, not \"$EndNodes\""},
        {"$Nodes\n12", "$Nodes\n-1", "line 5: $Nodes: negative count -1"},
        {"$Nodes\n12", "$Nodes\n999999999999", "line 5: $Nodes: count out of range"},
        {"\n2 1 0 0\n", "\n2 nan 0 0\n", "non-finite coordinate at node 2"},
        {"$Elements\n2", "$Elements\n3", "element 3 of 3: an integer is expected, not \"$EndElements\""},
        {"$EndElements", "", "$Elements: unexpected end of file"},
        {"$Nodes", "$Knots", "$Knots: unexpected end of file"},
    };
    for (const auto& [from, to, message] : cases) {
        EXPECT_THAT(read_error(replaced(good, from, to)), HasSubstr(message)) << from << " -> " << to;
    }
    EXPECT_THAT(read_error(""), HasSubstr("the file is empty"));
    EXPECT_THAT(read_error("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"), HasSubstr("there is no $Nodes section"));
}

}  // namespace gmsh_io_test

}  // namespace subvol::test
