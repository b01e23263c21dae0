// SPDX-License-Identifier: Apache-2.0
#include "subvol/read_surface.h"

#include <gmock/gmock.h>

#include <fstream>

#include "lib/temp_folder.h"
#include "subvol/error.h"

namespace subvol {
namespace read_surface_test {

using test::error_of;
using testing::HasSubstr;

class ReadSurface : public test::TempFolder {
protected:
    [[nodiscard]] std::string wrong(const std::string& name, const std::string& text) const {
        return error_of([&] { std::ignore = read_surface(write(name, text)); });
    }
};

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
    return "facet normal 0 0 0\n outer loop\n vertex " + a + "\n vertex " + b + "\n vertex " + c + "\n endloop\nendfacet\n";
}

TEST_F(ReadSurface, StlAsTextJoinsEqualPoints) {
    const Surface surface = read_surface(
        write("a.stl", "solid a\n" + facet("0 0 0", "1 0 0", "0 1 0") + facet("1 0 0", "1 1 0", "0 1 0") + "endsolid a\n"));
    EXPECT_EQ(surface.points.size(), 4U);
    EXPECT_EQ(surface.triangles.size(), 2U);
    EXPECT_EQ(surface.triangles[1][0], surface.triangles[0][1]);
}

TEST_F(ReadSurface, BinaryStlMayBeginWithSolid) {
    std::string text = "solid but binary";
    text.resize(84, '\0');
    text[80] = 1;
    const std::array<float, 12> numbers{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2.5F, 0};
    text.append(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
    text.append(2, '\0');
    const Surface surface = read_surface(write("a.STL", text));
    ASSERT_EQ(surface.triangles.size(), 1U);
    EXPECT_EQ(surface.points[surface.triangles[0][2]], Vec3(0, 2.5, 0));
    text.pop_back();
    EXPECT_THAT(wrong("b.stl", "x" + text.substr(1)), HasSubstr("b.stl, byte 80: the file should have 1 triangles"));
}

TEST_F(ReadSurface, ObjHasPolygonsAndCornersFromTheEnd) {
    const Surface surface = read_surface(write(
        "a.obj", "# a square\nv 0 0 0\nv 1 0 0 .5 .5 .5\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1/1 3//1 4\nf -4 -3 -1 # again\n"));
    EXPECT_EQ(surface.points.size(), 4U);
    ASSERT_EQ(surface.triangles.size(), 3U);
    EXPECT_EQ(surface.triangles[1], (std::array<Index, 3>{0, 2, 3}));
    EXPECT_EQ(surface.triangles[2], (std::array<Index, 3>{0, 1, 3}));
}

TEST_F(ReadSurface, PlyHasFacesOrStrips) {
    const std::string points =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    const std::string rows = "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    const Surface faces = read_surface(
        write("a.ply", points + "element face 1\nproperty list uchar int vertex_indices\n" + rows + "4 0 1 3 2\n"));
    EXPECT_EQ(faces.triangles, (std::vector<std::array<Index, 3>>{{0, 1, 3}, {0, 3, 2}}));
    const Surface strips = read_surface(
        write("b.ply", points + "element tristrips 1\nproperty list int int vertex_indices\n" + rows + "8 0 1 2 3 -1 0 1 3\n"));
    EXPECT_EQ(strips.triangles, (std::vector<std::array<Index, 3>>{{0, 1, 2}, {2, 1, 3}, {0, 1, 3}}));
}

TEST_F(ReadSurface, SaysWhatIsWrongAndWhere) {
    EXPECT_THAT(wrong("a.txt", ""), HasSubstr("is not a format of surfaces (.stl, .obj, .ply, .glb)"));
    EXPECT_THAT(wrong("a.stl", "hello"), HasSubstr("not an STL file"));
    EXPECT_THAT(wrong("a.stl", "solid\nendsolid\n"), HasSubstr("a.stl: "));
    EXPECT_THAT(wrong("a.stl", "solid\nendsolid\n"), HasSubstr("no triangles"));
    EXPECT_THAT(wrong("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n"), HasSubstr("a.stl, line 4: "));
    EXPECT_THAT(wrong("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\nendfacet\n"),
                HasSubstr("a facet does not have 3 vertices"));
    EXPECT_THAT(wrong("a.stl", "solid\nfaces\n"), HasSubstr("\"faces\" is not a word of an .stl file"));
    EXPECT_THAT(wrong("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
                HasSubstr("a.obj, line 4: a face has the corner 4 (1 to 3"));
    EXPECT_THAT(wrong("a.obj", "v 0 0 0\nf 1 x 1\n"), HasSubstr("\"x\" is not a corner"));
    EXPECT_THAT(wrong("a.obj", "v 0 0 0\nf 1 1\n"), HasSubstr("fewer than 3 corners"));
    EXPECT_THAT(wrong("a.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("not finite"));
    EXPECT_THAT(wrong("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"),
                HasSubstr("has no numbers x, y and z"));
    EXPECT_THAT(wrong("a.ply",
                      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 7\n"),
                HasSubstr("face 0 has the corner 7, which is not a vertex (0 to 0)"));
    EXPECT_THAT(wrong("a.ply",
                      "ply\nformat binary_little_endian 1.0\nelement vertex 1000000\nproperty float x\nproperty float y\n"
                      "property float z\nend_header\nabc"),
                HasSubstr("goes beyond the end of the file"));
}

std::string ply(const std::string& vertices, const std::string& faces, const std::string& rows,
                const std::string& corner = "int") {
    return "ply\nformat ascii 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces + "\nproperty list uchar " + corner +
           " vertex_indices\nend_header\n" + rows;
}

TEST_F(ReadSurface, PlyThatLies) {
    const std::string points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    EXPECT_EQ(wrong("a.ply", ply("4", "2", points + "3 0 1 2\n\n 3 0 1 3 \n\n")), "no error") << "empty lines say nothing";
    EXPECT_THAT(wrong("a.ply", ply("4", "1", points + "3 0 1 2\n3 0 1 3\n")), HasSubstr("more after the last element"));
    EXPECT_THAT(wrong("a.ply", ply("3", "2", points + "3 0 1 2\n3 0 1 3\n")), HasSubstr("a.ply, line 13"));
    EXPECT_THAT(wrong("a.ply", ply("4", "2", points + "3 0 1 1.5\n3 0 1 3\n")), HasSubstr("1.5, which is not whole"));
    EXPECT_THAT(wrong("a.ply", ply("4", "2", points + "3 0 1 1.5\n3 0 1 3\n", "float")), HasSubstr("corner 1.5"));
    EXPECT_THAT(wrong("a.ply", ply("4", "2", points + "0\n3 0 1 3\n")), HasSubstr("face 0 has 0 corners (at least 3)"));
    EXPECT_THAT(wrong("a.ply", ply("4", "2", points + "2 0 1\n3 0 1 3\n")), HasSubstr("face 0 has 2 corners"));
    EXPECT_THAT(wrong("a.ply", ply("4", "2", points + "3 0 1 2 3\n3 0 1 3\n")), HasSubstr("more numbers than it should"));
    EXPECT_THAT(wrong("a.ply", ply("4", "2", "0 0 0\n1 0\n0 0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n")),
                HasSubstr("\"vertex\" 1: its line has fewer numbers than it should"));
    EXPECT_THAT(wrong("a.ply", ply("4", "2", points + "3 0 1 2\n3 0 1 -1\n")), HasSubstr("corner -1"));
}

TEST_F(ReadSurface, BinaryPlyThatLies) {
    std::string text =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar float vertex_indices\nend_header\n";
    const std::array<float, 9> points{0, 0, 0, 1, 0, 0, 0, 1, 0};
    const auto with_corners = [&](const std::array<float, 3>& corners) {
        std::string all = text + std::string(reinterpret_cast<const char*>(points.data()), sizeof points) + '\3';
        return all.append(reinterpret_cast<const char*>(corners.data()), sizeof corners);
    };
    EXPECT_EQ(read_surface(write("a.ply", with_corners({0, 1, 2}))).triangles.size(), 1U);
    EXPECT_EQ(read_surface(write("a.ply", with_corners({0, 1, 2}) + "\r\n")).triangles.size(), 1U);
    EXPECT_THAT(wrong("a.ply", with_corners({0, 1, 1.5F})), HasSubstr("face 0 has the corner 1.5"));
    EXPECT_THAT(wrong("a.ply", with_corners({0, 1, 2}) + with_corners({0, 1, 2}).substr(text.size() + 36)),
                HasSubstr("more after the last element than the header says: 13 bytes"));
}

TEST_F(ReadSurface, ObjThatLies) {
    const std::string rest = "v 0 1 0\nf 1 2 3\n";
    EXPECT_EQ(wrong("a.obj", "v 0 0 0\nv 1 0 0 1 # a weight\n" + rest), "no error");
    EXPECT_THAT(wrong("a.obj", "v 0 0 0\nv 1 0\n" + rest), HasSubstr("a.obj, line 2: vertex 1 has 2 numbers (x, y and z"));
    EXPECT_THAT(wrong("a.obj", "v\n0 0 0\nv 1 0 0\n" + rest), HasSubstr("vertex 0 has 0 numbers"));
    EXPECT_THAT(wrong("a.obj", "v 0 0 0\nv 1 0 0 x\n" + rest), HasSubstr("not \"x\""));
    EXPECT_THAT(wrong("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1.5\n"), HasSubstr("\"1.5\" is not a corner"));
}

TEST_F(ReadSurface, TextStlThatLies) {
    const std::string one = facet("0 0 0", "1 0 0", "0 1 0");
    const auto vertices = [](int count) {
        std::string text = "facet normal 0 0 0\nouter loop\n";
        for (int k = 0; k < count; ++k) text += "vertex " + std::to_string(k) + " 0 " + std::to_string(k * k) + "\n";
        return text + "endloop\nendfacet\n";
    };
    EXPECT_EQ(wrong("a.stl", "solid a\n" + one + "endsolid a\nsolid b\n" + one + "endsolid b\n"), "no error");
    for (const int count : {0, 2, 4, 6})
        EXPECT_THAT(wrong("a.stl", "solid\n" + one + vertices(count) + "endsolid\n"), HasSubstr("does not have 3 vertices"));
    EXPECT_THAT(wrong("a.stl", "solid\n" + one), HasSubstr("the file ends within a solid"));
    EXPECT_THAT(wrong("a.stl", "solid\n" + one.substr(0, one.rfind("endfacet")) + one + "endsolid\n"), HasSubstr("facet"));
    EXPECT_THAT(wrong("a.stl", "solid\nvertex 0 0 0\n" + one + "endsolid\n"), HasSubstr("a vertex is in no facet"));
}

}  // namespace read_surface_test
}  // namespace subvol
