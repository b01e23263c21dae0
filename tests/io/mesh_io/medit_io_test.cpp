// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <array>

#include "lib/test_meshes.h"
#include "mesh_files.h"
#include "mesh_texts.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

namespace medit_io_test {

using testing::ElementsAre;
using testing::HasSubstr;

class MeditIo : public MeshFiles {};

const HexMesh kBox = make_box(2, 2, 2);

void expect_box(const HexMesh& mesh) {
    expect_same_geometry(mesh, kBox);
}

TEST_F(MeditIo, LetsTheSectionsComeInAnyOrder) {
    const std::string text = "MeshVersionFormatted 2 Dimension\n3\nHexahedra\n8\n" + cell_lines(kBox, 1, "", " 7") +
                             "Vertices 27\n" + point_lines(kBox, " -1");
    expect_box(read("a.mesh", text).mesh);
}

TEST_F(MeditIo, TakesMarksLineEndsCommentsAndOtherSections) {
    const std::string good = medit_text(kBox), mark = "\xEF\xBB\xBF";
    const std::string extra = "Corners\n2\n1\n2\nRequiredVertices 1\n3\nQuads\n1\n1 2 5 4 0\nHexahedra";
    for (const std::string& text : {with_crlf(good), mark + good, mark + with_crlf(good),
                                    "# Hexahedra 7\n\n" + replaced(good, "Vertices", "# Vertices 1\nVertices # 2"),
                                    replaced(good, "Hexahedra", extra), replaced(good, "End\n", "")}) {
        expect_box(read("a.mesh", text).mesh);
    }
    EXPECT_THAT(read("a.mesh", replaced(good, "Hexahedra", extra)).warnings, ElementsAre(HasSubstr("Quads")));
}

TEST_F(MeditIo, TakesWhatNumbersMayLookLike) {
    const auto text = replaced(medit_text(kBox), "\n1 0 0 0\n", "\n+1.0E+0 1e-400 -0.0 0 # a comment 9 9\n");
    EXPECT_EQ(read("a.MESH", text).mesh.points[1], Vec3(1, 0, 0));
}

TEST_F(MeditIo, WhatIsNotReadIsNamed) {
    EXPECT_THAT(read_error("a.mesh", "MFEM mesh v1.0\n\ndimension\n3\n"), HasSubstr("a mesh in MFEM's own format"));
    EXPECT_THAT(
        read_error("a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 1\n0 0 0 0\nHexahedraQ2 1\n1 1 1 0\nTriangles 0\n"),
        HasSubstr("no hexahedra, but HexahedraQ2 (1), which are ignored"));
}

TEST_F(MeditIo, ErrorsNameThePlace) {
    const std::string good = medit_text(kBox);
    const std::vector<std::array<std::string, 3>> cases{
        {"Vertices", "Corners 0 Vertikes", "there is no Vertices section"},
        {"Dimension 3\n", "", "line 2: Vertices come before Dimension"},
        {"1 1 1 0", "1 1 nan 0", "line 18: non-finite coordinate at vertex 14"},
        {"1 1 1 0", "1 1 1.0.0 0", "line 18: vertex 14 of 27: a number is expected, not \"1.0.0\""},
        {"1 1 1 0", "1 1 1 0.5", "line 18: reference of vertex 14 of 27: an integer is expected, not \"0.5\""},
        {"1 1 1 0", "1 1 1 0 0", "line 31: section: a keyword is expected, not \"0\""},
        {"\n27\n", "\n26\n", "line 31: section: a keyword is expected, not \"2\""},
        {"\n27\n", "\n28\n", "line 32: vertex 28 of 28: a number is expected, not \"Hexahedra\""},
        {"\n8\n", "\n9\n", "line 42: hex 9 of 9: an integer is expected, not \"End\""},
        {"\n8\n", "\n7\n", "line 41: section: a keyword is expected, not \"14\""},
        {"\n14 15", "\n1 28", "line 41: hex 8: there is no vertex with index 28"},
        {"\n14 15", "\n0 15", "line 41: hex 8: there is no vertex with index 0"},
        {"End", "Hexahedra 0", "line 42: there is a second Hexahedra section"},
    };
    for (const auto& [from, to, message] : cases) {
        EXPECT_THAT(read_error("a.mesh", replaced(good, from, to)), HasSubstr(message)) << from << " -> " << to;
    }
    EXPECT_THAT(read_error("a.mesh", "  \n"), HasSubstr("the file is empty"));
}

TEST_F(MeditIo, ReadsEveryKindOfCell) {
    const std::string cells = "Tetrahedra 1\n1 2 3 5 0\nPrisms 1\n1 2 3 6 7 8 0\nPyramids 1\n1 2 7 6 4 0\n";
    const std::string vertices = "Vertices 8\n0 0 0 0\n1 0 0 0\n0 1 0 0\n.5 -1 .5 0\n0 0 -1 0\n0 0 1 0\n1 0 1 0\n0 1 1 0\n";
    for (const std::string& body : {vertices + cells, cells + vertices}) {
        const ReadResult result = read("a.mesh", "MeshVersionFormatted 2\nDimension 3\n" + body + "End\n");
        EXPECT_THAT(result.warnings,
                    ElementsAre("1 tetrahedron, 1 prism and 1 pyramid cut into 6 tetrahedra and split into 24 hexahedra"));
    }
    const auto error = [&](const std::string& from, const std::string& to) {
        return read_error("a.mesh", "MeshVersionFormatted 2\nDimension 3\n" + vertices + replaced(cells, from, to) + "End\n");
    };
    EXPECT_THAT(error("1 2 3 5 0", "1 2 3 9 0"), HasSubstr("tetrahedron 1: there is no vertex with index 9"));
    EXPECT_THAT(error("7 6 4 0", "1 6 4 0"), HasSubstr("a cell has vertex 1 twice, at corners that no collapsed edge joins"));
    EXPECT_THAT(error("Pyramids", "Prisms"), HasSubstr("there is a second Prisms section"));
}

}  // namespace medit_io_test

}  // namespace subvol::test
