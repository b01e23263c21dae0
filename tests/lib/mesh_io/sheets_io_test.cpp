// SPDX-License-Identifier: Apache-2.0
// Quads and lines beside hexahedra, in legacy VTK, VTK XML and Gmsh.
#include <gmock/gmock.h>

#include <cmath>

#include "lib/test_meshes.h"
#include "mesh_files.h"
#include "mesh_texts.h"

namespace subvol::test {

namespace sheets_io_test {

using testing::ElementsAre;
using testing::HasSubstr;

class SheetsIo : public MeshFiles {};

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
std::string vtk_with_sheets(const std::string& more_cells = "", std::size_t more = 0, std::size_t more_numbers = 0,
                            const std::string& more_types = "") {
    const HexMesh mesh = cell_and_points();
    return "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 13 double\n" + point_lines(mesh) +
           "CELLS " + std::to_string(6 + more) + " " + std::to_string(9 + 3 * 5 + 2 * 3 + more_numbers) +
           "\n2 4 5\n4 0 1 3 2\n" + cell_lines(mesh, 0, "8 ") + "4 4 5 9 8\n4 8 9 11 10\n2 11 12\n" + more_cells +
           "CELL_TYPES " + std::to_string(6 + more) + "\n3\n9\n12\n9\n9\n3\n" + more_types;
}

void expect_fin_and_rod(const Sheets& sheets) {
    ASSERT_EQ(sheets.points.size(), 7u);
    EXPECT_THAT(sheets.quads, ElementsAre(std::array<Index, 4>{0, 1, 3, 2}, std::array<Index, 4>{2, 3, 5, 4}));
    EXPECT_THAT(sheets.lines, ElementsAre(std::array<Index, 2>{5, 6}));
    EXPECT_EQ(sheets.points[0], Vec3(0, 0, 1));
    EXPECT_EQ(sheets.points[6], Vec3(3, 0, 3));
    EXPECT_EQ(sheets.solid[0], (CellCorner{0, 4}));
    EXPECT_EQ(sheets.solid[1], (CellCorner{0, 5}));
    for (std::size_t p = 2; p < 7; ++p) EXPECT_EQ(sheets.solid[p].cell, kNone);
}

TEST_F(SheetsIo, QuadsAndLinesOfVtkAreSheetsAndCurves) {
    const ReadResult found = read("a.vtk", vtk_with_sheets());
    expect_fin_and_rod(found.sheets);
    EXPECT_THAT(found.warnings, ElementsAre("1 line (VTK type 3), 1 quad (VTK type 9) ignored"));  // parts of the cell
}

TEST_F(SheetsIo, TheMeshIsTheSameWithThemAndWithout) {
    const HexMesh mesh = cell_and_points();
    const HexMesh without = read("a.vtk", vtk_text(mesh)).mesh, with = read("b.vtk", vtk_with_sheets()).mesh;
    expect_same_geometry(without, with);
}

TEST_F(SheetsIo, ValuesAtPointsAndCellsAreThoseOfTheFile) {
    const std::string data =
        "POINT_DATA 13\nSCALARS p double\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10 11 12\n"
        "CELL_DATA 6\nSCALARS c double\nLOOKUP_TABLE default\n100 200 7 1 3 5\n";
    const Sheets sheets = read("a.vtk", vtk_with_sheets() + data).sheets;
    ASSERT_EQ(sheets.attributes.size(), 2u);
    EXPECT_THAT(sheets.attributes[0].values, ElementsAre(4, 5, 8, 9, 10, 11, 12));
    // On the cell its own value; else the mean over the quads and lines: 2 between the quads, 4 at the rod's foot.
    EXPECT_THAT(sheets.attributes[1].values, ElementsAre(7, 7, 2, 2, 3, 4, 5));
}

TEST_F(SheetsIo, GmshHasThemToo) {
    const HexMesh mesh = cell_and_points();
    std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n13\n";
    for (std::size_t p = 0; p < 13; ++p) {
        text += std::to_string(p + 1) + " " + number(mesh.points[p].x) + " " + number(mesh.points[p].y) + " " +
                number(mesh.points[p].z) + "\n";
    }
    text += "$EndNodes\n$Elements\n7\n1 1 2 0 1 5 6\n2 3 2 0 1 1 2 4 3\n" + cell_lines(mesh, 1, "3 5 2 0 1 ") +
            "4 3 2 0 1 5 6 10 9\n5 3 2 0 1 9 10 12 11\n6 1 2 0 1 12 13\n7 1 2 0 1 12 99\n$EndElements\n";
    const ReadResult found = read("a.msh", text);
    expect_fin_and_rod(found.sheets);
    EXPECT_THAT(found.warnings, ElementsAre("2 lines, 1 quad ignored"));  // of the cell, and one with an unknown node
}

TEST_F(SheetsIo, AreWrittenAndReadAgain) {
    ReadResult found = read("a.vtk", vtk_with_sheets());
    add_field(found.mesh, "f", [](const Vec3& p) { return p.x - 2 * p.z; });
    Sheets sheets = found.sheets;
    sheets.attributes.push_back({"f", 1, {}});
    for (const Vec3& p : sheets.points) sheets.attributes[0].values.push_back(p.x - 2 * p.z);
    const HexMesh mesh = without_unused_points(found.mesh);
    EXPECT_TRUE(write_mesh(path("b.vtu"), mesh, sheets).empty());
    const ReadResult again = read_mesh(path("b.vtu"));
    expect_fin_and_rod(again.sheets);
    EXPECT_EQ(again.sheets.attributes[0].values, sheets.attributes[0].values);
    expect_same_geometry(without_unused_points(again.mesh), mesh);
    EXPECT_THAT(error_of([&] { write_mesh(path("b.mesh"), mesh, sheets); }), HasSubstr("sheets and curves cannot be written"));
    write_mesh(path("c.vtu"), mesh, {});
    expect_same_geometry(read_mesh(path("c.vtu")).mesh, mesh);
}

TEST_F(SheetsIo, AreWeldedToTheCells) {
    HexMesh mesh = cell_and_points();
    mesh.points.push_back({0, 0, 1});
    mesh.points.push_back({1, 0, 1});
    const std::string text = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 15 double\n" +
                             point_lines(mesh) + "CELLS 2 14\n4 13 14 9 8\n" + cell_lines(mesh, 0, "8 ") +
                             "CELL_TYPES 2\n9\n12\n";
    EXPECT_EQ(inspect(read("a.vtk", text).sheets).attached, 0u);
    const ReadResult welded = read("a.vtk", text, {.weld = 0});
    EXPECT_EQ(inspect(welded.sheets).attached, 2u);
    EXPECT_EQ(welded.mesh.cells, mesh.cells);
}

TEST_F(SheetsIo, AreLeftOutBesideOtherCellsAndSaid) {
    const ReadResult found = read("a.vtk", vtk_with_sheets("4 8 9 10 12\n", 1, 5, "10\n"));
    EXPECT_TRUE(found.sheets.empty());
    EXPECT_THAT(found.warnings.front(), HasSubstr("2 lines (VTK type 3), 3 quads (VTK type 9) ignored"));
    const ReadResult triangle = read("b.vtk", vtk_with_sheets("3 8 9 10\n", 1, 4, "5\n"));
    EXPECT_THAT(triangle.warnings.front(), HasSubstr("1 triangle (VTK type 5)"));
    expect_fin_and_rod(triangle.sheets);
}

TEST_F(SheetsIo, UnusableOnesAreLeftOutAndSaid) {
    const ReadResult twice = read("a.vtk", vtk_with_sheets("4 8 9 9 10\n2 9 9\n", 2, 8, "9\n3\n"));
    expect_fin_and_rod(twice.sheets);
    EXPECT_THAT(twice.warnings.back(), HasSubstr("1 quad and 1 line ignored: they repeat a point"));
    const std::string data = "POINT_DATA 13\nSCALARS p double\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10 11 nan\n";
    const ReadResult no_value = read("b.vtk", vtk_with_sheets() + data);
    EXPECT_TRUE(no_value.sheets.lines.empty());
    EXPECT_EQ(no_value.sheets.quads.size(), 2u);
    const ReadResult short_quad = read("c.vtk", vtk_with_sheets("3 8 9 10\n", 1, 4, "9\n"));
    expect_fin_and_rod(short_quad.sheets);
}

TEST_F(SheetsIo, MalformedOnesAreRefused) {
    EXPECT_THAT(read_error("a.vtk", vtk_with_sheets("4 8 9 10 99\n", 1, 5, "9\n")), HasSubstr("99"));
    EXPECT_THAT(read_error("b.vtk", vtk_with_sheets("2 8 -1\n", 1, 3, "3\n")), HasSubstr("-1"));
    std::string alone =
        "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
        "0 0 0 1 0 0 1 1 0 0 1 0\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n9\n";
    EXPECT_THAT(read_error("c.vtk", alone), HasSubstr("no hexahedra, but 1 quad (VTK type 9), which are ignored"));
    const ReadResult wanted = read("c.vtk", alone, {.sheets_alone = true});
    EXPECT_TRUE(wanted.mesh.cells.empty());
    EXPECT_EQ(wanted.sheets.quads.size(), 1u);
    EXPECT_TRUE(wanted.warnings.empty());
    alone = replaced_once(alone, "4 0 1 2 3", "4 0 1 2 2");  // none of them can be used
    EXPECT_THAT(error_of([&] { static_cast<void>(read("d.vtk", alone, {.sheets_alone = true})); }),
                HasSubstr("the mesh has no hexahedra"));
}

}  // namespace sheets_io_test

}  // namespace subvol::test
