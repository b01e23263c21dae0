// SPDX-License-Identifier: Apache-2.0
// Quads and lines beside hexahedra, in legacy VTK, VTK XML and Gmsh.
#include <gmock/gmock.h>

#include <cmath>

#include "lib/test_meshes.h"
#include "mesh_files.h"
#include "mesh_texts.h"

namespace subvol::test {

namespace shells_io_test {

using testing::ElementsAre;
using testing::HasSubstr;

class ShellsIo : public MeshFiles {};

std::string replaced_once(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
}

/// A cell with four more points: a fin of two quads on its edge 4-5, whose points are 8 to 11, and a rod to point 12.
HexMesh cell_and_points() {
    HexMesh mesh = make_box(1, 1, 1);
    for (const Vec3& p : {Vec3(0, 0, 2), Vec3(1, 0, 2), Vec3(0, 0, 3), Vec3(1, 0, 3), Vec3(3, 0, 3)}) mesh.points.push_back(p);
    return mesh;
}

/// Beside the cell: an edge and a face of it, the fin and the rod.
std::string vtk_with_shells(const std::string& more_cells = "", std::size_t more = 0, std::size_t more_numbers = 0,
                            const std::string& more_types = "") {
    const HexMesh mesh = cell_and_points();
    return "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 13 double\n" + point_lines(mesh) +
           "CELLS " + std::to_string(6 + more) + " " + std::to_string(9 + 3 * 5 + 2 * 3 + more_numbers) +
           "\n2 4 5\n4 0 1 3 2\n" + cell_lines(mesh, 0, "8 ") + "4 4 5 9 8\n4 8 9 11 10\n2 11 12\n" + more_cells +
           "CELL_TYPES " + std::to_string(6 + more) + "\n3\n9\n12\n9\n9\n3\n" + more_types;
}

void expect_fin_and_rod(const Shells& shells) {
    ASSERT_EQ(shells.points.size(), 7u);
    EXPECT_THAT(shells.quads, ElementsAre(std::array<Index, 4>{0, 1, 3, 2}, std::array<Index, 4>{2, 3, 5, 4}));
    EXPECT_THAT(shells.lines, ElementsAre(std::array<Index, 2>{5, 6}));
    EXPECT_EQ(shells.points[0], Vec3(0, 0, 1));
    EXPECT_EQ(shells.points[6], Vec3(3, 0, 3));
    EXPECT_EQ(shells.solid[0], (CellCorner{0, 4}));
    EXPECT_EQ(shells.solid[1], (CellCorner{0, 5}));
    for (std::size_t p = 2; p < 7; ++p) EXPECT_EQ(shells.solid[p].cell, kNone);
}

TEST_F(ShellsIo, QuadsAndLinesOfVtkAreSheetsAndCurves) {
    const ReadResult found = read("a.vtk", vtk_with_shells());
    expect_fin_and_rod(found.shells);
    EXPECT_THAT(found.warnings, ElementsAre("1 line (VTK type 3), 1 quad (VTK type 9) ignored"));  // parts of the cell
}

TEST_F(ShellsIo, TheMeshIsTheSameWithThemAndWithout) {
    const HexMesh mesh = cell_and_points();
    const HexMesh without = read("a.vtk", vtk_text(mesh)).mesh, with = read("b.vtk", vtk_with_shells()).mesh;
    expect_same_geometry(without, with);
}

TEST_F(ShellsIo, ValuesAtPointsAndCellsAreThoseOfTheFile) {
    const std::string data =
        "POINT_DATA 13\nSCALARS p double\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10 11 12\n"
        "CELL_DATA 6\nSCALARS c double\nLOOKUP_TABLE default\n100 200 7 1 3 5\n";
    const Shells shells = read("a.vtk", vtk_with_shells() + data).shells;
    ASSERT_EQ(shells.attributes.size(), 2u);
    EXPECT_THAT(shells.attributes[0].values, ElementsAre(4, 5, 8, 9, 10, 11, 12));
    // On the cell its own value; else the mean over the quads and lines: 2 between the quads, 4 at the rod's foot.
    EXPECT_THAT(shells.attributes[1].values, ElementsAre(7, 7, 2, 2, 3, 4, 5));
}

TEST_F(ShellsIo, GmshHasThemToo) {
    const HexMesh mesh = cell_and_points();
    std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n13\n";
    for (std::size_t p = 0; p < 13; ++p) {
        text += std::to_string(p + 1) + " " + number(mesh.points[p].x) + " " + number(mesh.points[p].y) + " " +
                number(mesh.points[p].z) + "\n";
    }
    text += "$EndNodes\n$Elements\n7\n1 1 2 0 1 5 6\n2 3 2 0 1 1 2 4 3\n" + cell_lines(mesh, 1, "3 5 2 0 1 ") +
            "4 3 2 0 1 5 6 10 9\n5 3 2 0 1 9 10 12 11\n6 1 2 0 1 12 13\n7 1 2 0 1 12 99\n$EndElements\n";
    const ReadResult found = read("a.msh", text);
    expect_fin_and_rod(found.shells);
    EXPECT_THAT(found.warnings, ElementsAre("2 lines, 1 quad ignored"));  // of the cell, and one with an unknown node
}

TEST_F(ShellsIo, AreWrittenAndReadAgain) {
    ReadResult found = read("a.vtk", vtk_with_shells());
    add_field(found.mesh, "f", [](const Vec3& p) { return p.x - 2 * p.z; });
    Shells shells = found.shells;
    shells.attributes.push_back({"f", 1, {}});
    for (const Vec3& p : shells.points) shells.attributes[0].values.push_back(p.x - 2 * p.z);
    const HexMesh mesh = without_unused_points(found.mesh);
    EXPECT_TRUE(write_mesh(path("b.vtu"), mesh, shells).empty());
    const ReadResult again = read_mesh(path("b.vtu"));
    expect_fin_and_rod(again.shells);
    EXPECT_EQ(again.shells.attributes[0].values, shells.attributes[0].values);
    expect_same_geometry(without_unused_points(again.mesh), mesh);
    EXPECT_THAT(error_of([&] { write_mesh(path("b.mesh"), mesh, shells); }), HasSubstr("shells and beams cannot be written"));
    write_mesh(path("c.vtu"), mesh, {});
    expect_same_geometry(read_mesh(path("c.vtu")).mesh, mesh);
}

TEST_F(ShellsIo, AreWeldedToTheCells) {
    HexMesh mesh = cell_and_points();
    mesh.points.push_back({0, 0, 1});
    mesh.points.push_back({1, 0, 1});
    const std::string text = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 15 double\n" +
                             point_lines(mesh) + "CELLS 2 14\n4 13 14 9 8\n" + cell_lines(mesh, 0, "8 ") +
                             "CELL_TYPES 2\n9\n12\n";
    EXPECT_EQ(inspect(read("a.vtk", text).shells).attached, 0u);
    const ReadResult welded = read("a.vtk", text, {.weld = 0});
    EXPECT_EQ(inspect(welded.shells).attached, 2u);
    EXPECT_EQ(welded.mesh.cells, mesh.cells);
}

TEST_F(ShellsIo, AreLeftOutBesideOtherCellsAndSaid) {
    const ReadResult found = read("a.vtk", vtk_with_shells("4 8 9 10 12\n", 1, 5, "10\n"));
    EXPECT_TRUE(found.shells.empty());
    EXPECT_THAT(found.warnings.front(), HasSubstr("2 lines (VTK type 3), 3 quads (VTK type 9) ignored"));
    const ReadResult triangle = read("b.vtk", vtk_with_shells("3 8 9 10\n", 1, 4, "5\n"));
    EXPECT_THAT(triangle.warnings.front(), HasSubstr("1 triangle (VTK type 5)"));
    expect_fin_and_rod(triangle.shells);
}

TEST_F(ShellsIo, UnusableOnesAreLeftOutAndSaid) {
    const ReadResult twice = read("a.vtk", vtk_with_shells("4 8 9 9 10\n2 9 9\n", 2, 8, "9\n3\n"));
    expect_fin_and_rod(twice.shells);
    EXPECT_THAT(twice.warnings.back(), HasSubstr("1 quad and 1 line ignored: they repeat a point"));
    const std::string data = "POINT_DATA 13\nSCALARS p double\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10 11 nan\n";
    const ReadResult no_value = read("b.vtk", vtk_with_shells() + data);
    EXPECT_TRUE(no_value.shells.lines.empty());
    EXPECT_EQ(no_value.shells.quads.size(), 2u);
    const ReadResult short_quad = read("c.vtk", vtk_with_shells("3 8 9 10\n", 1, 4, "9\n"));
    expect_fin_and_rod(short_quad.shells);
}

TEST_F(ShellsIo, MalformedOnesAreRefused) {
    EXPECT_THAT(read_error("a.vtk", vtk_with_shells("4 8 9 10 99\n", 1, 5, "9\n")), HasSubstr("99"));
    EXPECT_THAT(read_error("b.vtk", vtk_with_shells("2 8 -1\n", 1, 3, "3\n")), HasSubstr("-1"));
    std::string alone =
        "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
        "0 0 0 1 0 0 1 1 0 0 1 0\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n9\n";
    EXPECT_THAT(read_error("c.vtk", alone), HasSubstr("no hexahedra, but 1 quad (VTK type 9), which are ignored"));
    const ReadResult wanted = read("c.vtk", alone, {.shells_alone = true});
    EXPECT_TRUE(wanted.mesh.cells.empty());
    EXPECT_EQ(wanted.shells.quads.size(), 1u);
    EXPECT_TRUE(wanted.warnings.empty());
    alone = replaced_once(alone, "4 0 1 2 3", "4 0 1 2 2");  // none of them can be used
    EXPECT_THAT(error_of([&] { static_cast<void>(read("d.vtk", alone, {.shells_alone = true})); }),
                HasSubstr("the mesh has no hexahedra"));
}

}  // namespace shells_io_test

}  // namespace subvol::test
