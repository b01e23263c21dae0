// SPDX-License-Identifier: Apache-2.0
// Structured grids as hexahedra: VTK XML (.vts) and legacy VTK.

#include <gmock/gmock.h>

#include "lib/test_meshes.h"
#include "mesh_files.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"
#include "vtu_texts.h"

namespace subvol::test {

namespace structured_io_test {

using testing::ElementsAre;
using testing::HasSubstr;

// Points and cells are counted along x first, then y, then z, as in a structured grid.
const HexMesh kBox = make_box(3, 2, 4);

std::vector<double> count_up(std::size_t count) {
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<double>(i);
    return values;
}

std::string legacy_text(const std::string& dimensions, const HexMesh& mesh) {
    return "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS " + dimensions + "\nPOINTS " +
           std::to_string(mesh.points.size()) + " double\n" + point_lines(mesh);
}

std::string vts_piece(VtuText& vtu, const HexMesh& mesh, const std::string& extent, const std::string& data = "") {
    return "<Piece Extent=\"" + extent + "\">\n" + data + "<Points>\n" +
           vtu.array("Float64", "Name=\"Points\" NumberOfComponents=\"3\"", coordinates_as<double>(mesh)) +
           "</Points>\n</Piece>\n";
}

// type: StructuredGrid, RectilinearGrid or ImageData; attributes: of its element
std::string grid_file(const VtuText& vtu, const std::string& type, const std::string& attributes, const std::string& pieces) {
    const std::string unstructured = "UnstructuredGrid";
    std::string text = vtu.file(pieces);
    for (std::size_t at = 0; (at = text.find(unstructured)) != std::string::npos;) text.replace(at, unstructured.size(), type);
    return replaced(text, "<" + type + ">", "<" + type + " " + attributes + ">");
}

std::string vts_file(const VtuText& vtu, const std::string& pieces) {
    return grid_file(vtu, "StructuredGrid", "", pieces);
}

std::string cuts(VtuText& vtu) {
    return "<Coordinates>" + vtu.array("Float32", "Name=\"x\"", std::vector<float>{0, 1, 2, 3}) +
           vtu.array("Float64", "Name=\"y\"", std::vector<double>{0, 1, 2}) +
           vtu.array("Int8", "Name=\"z\"", std::vector<std::int8_t>{0, 1, 2, 3, 4}) + "</Coordinates>";
}

std::string values_of_box(VtuText& vtu) {
    return "<PointData>" + vtu.array("Float64", "Name=\"p\"", count_up(kBox.points.size())) + "</PointData><CellData>" +
           vtu.array("Float64", "Name=\"c\"", std::vector<double>(kBox.cells.size(), 7)) + "</CellData>";
}

class StructuredIo : public MeshFiles {};

void expect_box(const HexMesh& mesh) {
    expect_same_geometry(mesh, kBox);
    EXPECT_EQ(inspect(mesh).volume, 24);
}

void expect_box_with_values(const ReadResult& result) {
    expect_box(result.mesh);
    EXPECT_EQ(result.mesh.find_attribute("p")->values, count_up(kBox.points.size()));
    EXPECT_DOUBLE_EQ(result.mesh.find_attribute("c")->values.front(), 7);
}

TEST_F(StructuredIo, XmlInEveryEncoding) {
    for (const std::string format : {"ascii", "binary", "appended"}) {
        for (const std::string compressor : {"", "vtkZLibDataCompressor", "vtkLZ4DataCompressor"}) {
            if (format == "ascii" && !compressor.empty()) continue;
            VtuText vtu{.format = format, .compressor = compressor};
            const std::string data = values_of_box(vtu);
            expect_box_with_values(read("a.vts", vts_file(vtu, vts_piece(vtu, kBox, "-1 2 5 7 0 4", data))));
        }
    }
}

TEST_F(StructuredIo, XmlWithParallelPlanes) {
    for (const std::string format : {"ascii", "appended"}) {
        VtuText vtu{.format = format};
        const std::string data = cuts(vtu) + values_of_box(vtu);
        const std::string piece = "<Piece Extent=\"7 10 0 2 0 4\">" + data + "</Piece>";
        expect_box_with_values(read("a.vtr", grid_file(vtu, "RectilinearGrid", "", piece)));
    }
}

TEST_F(StructuredIo, XmlImages) {
    VtuText vtu;
    const auto image = [&](const std::string& attributes, const std::string& extent) {
        const std::string piece = "<Piece Extent=\"" + extent + "\">" + values_of_box(vtu) + "</Piece>";
        return read("a.vti", grid_file(vtu, "ImageData", attributes, piece));
    };
    expect_box_with_values(image("", "0 3 0 2 0 4"));
    // The origin belongs to the point number 0, wherever the piece begins.
    expect_box_with_values(image("Origin=\"-5 10 0\" Spacing=\"1 1 1\"", "5 8 -10 -8 0 4"));
    const auto turned = image("Origin=\"1 2 3\" Spacing=\"2 1 .5\" Direction=\"0 -1 0 1 0 0 0 0 1\"", "0 3 0 2 0 4");
    EXPECT_EQ(turned.mesh.points.back(), Vec3(1 - 2, 2 + 6, 3 + 2));
    EXPECT_EQ(inspect(turned.mesh).volume, 24);
}

TEST_F(StructuredIo, XmlErrorsOfParallelPlanes) {
    VtuText vtu;
    const std::string good = grid_file(vtu, "RectilinearGrid", "", "<Piece Extent=\"0 3 0 2 0 4\">" + cuts(vtu) + "</Piece>");
    EXPECT_THAT(read_error("a.vtr", replaced(good, "0 2 0 4", "0 3 0 4")),
                HasSubstr("it has 3 values (4 are needed: the coordinates along an axis)"));
    EXPECT_THAT(read_error("a.vtr", replaced(good, "<Coordinates>", "<Other>")), HasSubstr("not well-formed XML"));
    EXPECT_THAT(read_error("a.vtr", grid_file(vtu, "RectilinearGrid", "", "<Piece Extent=\"0 3 0 2 0 4\"/>")),
                HasSubstr("the piece does not have three arrays of Coordinates"));
    const auto image = [&](const std::string& attributes, const std::string& extent) {
        return read_error("a.vti", grid_file(vtu, "ImageData", attributes, "<Piece Extent=\"" + extent + "\"/>"));
    };
    EXPECT_THAT(image("Origin=\"0 0\"", "0 1 0 1 0 1"), HasSubstr("its Origin is \"0 0\" (3 numbers are needed)"));
    EXPECT_THAT(image("Spacing=\"1 x 1\"", "0 1 0 1 0 1"), HasSubstr("its Spacing is \"1 x 1\""));
    EXPECT_THAT(image("Spacing=\"1 nan 1\"", "0 1 0 1 0 1"), HasSubstr("non-finite coordinate at point 0"));
    EXPECT_THAT(image("Origin=\"0 0 inf\"", "0 1 0 1 0 1"), HasSubstr("non-finite coordinate at point 0"));
    EXPECT_THAT(image("", "0 999 0 999 0 999"),
                HasSubstr("1000 x 1000 x 1000 points are more than the file can have values for"));
    EXPECT_THAT(image("", "0 9 0 9 0 0"), HasSubstr("no hexahedra"));
}

TEST_F(StructuredIo, PiecesAreJoinedByWelding) {
    VtuText vtu;
    HexMesh left = make_box(1, 2, 4), right = make_box(2, 2, 4);
    for (Vec3& x : right.points) x.x += 1;
    const std::string text = vts_file(
        vtu, vts_piece(vtu, left, "0 1 0 2 0 4") + vts_piece(vtu, right, "1 3 0 2 0 4") + vts_piece(vtu, {}, "0 -1 0 -1 0 -1"));
    EXPECT_THAT(read("a.vts", text).warnings,
                ElementsAre(HasSubstr("3 pieces put together; points where they touch stay apart")));
    const ReadResult welded = read("a.vts", text, {.weld = 0});
    EXPECT_THAT(welded.warnings, ElementsAre("3 pieces put together", HasSubstr("15 points welded")));
    const MeshReport report = inspect(welded.mesh), whole = inspect(kBox);
    EXPECT_EQ(report.points_used, whole.points_used);
    EXPECT_EQ(report.edges, whole.edges);
    EXPECT_EQ(report.faces, whole.faces);
    EXPECT_EQ(report.boundary_faces, whole.boundary_faces);
}

TEST_F(StructuredIo, XmlErrors) {
    VtuText vtu;
    const std::string good = vts_file(vtu, vts_piece(vtu, kBox, "0 3 0 2 0 4"));
    const std::vector<std::array<std::string, 2>> cases{
        {"0 3 0 2 0", "its Extent is \"0 3 0 2 0\" (six integers are needed)"},
        {"0 3 0 2 0 4 0", "six integers are needed"},
        {"0 3 0 2 0 x", "six integers are needed"},
        {"0 3 0 2 0 9223372036854775807", "six integers are needed"},
        {"0 99999999 0 99999999 0 99999999", "too many points"},
        {"0 3 0 2 0 5", "it has 180 values (216 are needed: 3 coordinates of 72 points"},
        {"0 3 0 2 0 0", "it has 180 values (36 are needed"},
    };
    for (const auto& [extent, message] : cases) {
        EXPECT_THAT(read_error("a.vts", replaced(good, "0 3 0 2 0 4", extent)), HasSubstr(message)) << extent;
    }
    EXPECT_THAT(read_error("a.vts", replaced(vtu.file(""), "\"UnstructuredGrid\"", "\"PolyData\"")),
                HasSubstr("\"PolyData\" is not a StructuredGrid"));
}

std::string legacy_values() {
    std::string text = "POINT_DATA 60\nSCALARS p double 1\nLOOKUP_TABLE default\n";
    for (int p = 0; p < 60; ++p) text += std::to_string(p) + " ";
    text += "\nCELL_DATA 24\nSCALARS c int\nLOOKUP_TABLE default\n";
    for (int c = 0; c < 24; ++c) text += "7 ";
    return text;
}

TEST_F(StructuredIo, LegacyWithFields) {
    expect_box_with_values(read("a.vtk", legacy_text("4 3 5", kBox) + legacy_values()));
}

const std::string kLegacyHead = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET ";

TEST_F(StructuredIo, LegacyWithParallelPlanes) {
    const std::string cuts =
        "X_COORDINATES 4 float\n0 1 2 3\nY_COORDINATES 3 float\n0 1 2\nZ_COORDINATES 5 double\n0 1 2 3 4\n";
    const std::string head = kLegacyHead + "RECTILINEAR_GRID\nDIMENSIONS 4 3 5\n";
    expect_box_with_values(read("a.vtk", head + cuts + legacy_values()));
    expect_box(read("a.vtk", head + cuts).mesh);
    EXPECT_THAT(read_error("a.vtk", head + replaced(cuts, "4 float\n0 1 2 3", "3 float\n0 1 2")),
                HasSubstr("there are 3 X_COORDINATES, but DIMENSIONS says 4 x 3 x 5 points"));
    EXPECT_THAT(read_error("a.vtk", head + "POINTS 1 float\n0 0 0\n"), HasSubstr("a keyword is expected, not \"POINTS\""));
    const auto big = [](const std::vector<double>& values) { return bytes_of(values, std::endian::big) + "\n"; };
    expect_box(read("a.vtk", replaced(head, "ASCII", "BINARY") + "X_COORDINATES 4 double\n" + big({0, 1, 2, 3}) +
                                 "Y_COORDINATES 3 double\n" + big({0, 1, 2}) + "Z_COORDINATES 5 double\n" +
                                 big({0, 1, 2, 3, 4}))
                   .mesh);
}

TEST_F(StructuredIo, LegacyImages) {
    const std::string head = kLegacyHead + "STRUCTURED_POINTS\nDIMENSIONS 4 3 5\n";
    expect_box_with_values(read("a.vtk", head + legacy_values()));
    const ReadResult placed = read("a.vtk", head + "ORIGIN 1 2 3\nSPACING 2 1 .5\n" + legacy_values());
    EXPECT_EQ(placed.mesh.points.front(), Vec3(1, 2, 3));
    EXPECT_EQ(placed.mesh.points.back(), Vec3(7, 4, 5));
    for (const auto& [dimensions, message] : std::vector<std::array<std::string, 2>>{
             {"200 200 200", "200 x 200 x 200 points are more than the file can have values for"},
             {"60 0 1", "there is no cell between"},
             {"60 1 1", "there is no cell between 60 x 1 x 1 points"},
             {"4 3 6", "POINT_DATA is for 60 points, but there are 72"}}) {
        EXPECT_THAT(read_error("a.vtk", replaced(head, "4 3 5", dimensions) + legacy_values()), HasSubstr(message));
    }
}

TEST_F(StructuredIo, LegacyBinary) {
    const std::string text =
        "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET STRUCTURED_GRID\nDIMENSIONS 4 3 5\nPOINTS 60 double\n" +
        bytes_of(coordinates_as<double>(kBox), std::endian::big) + "\n";
    expect_box(read("a.vtk", text).mesh);
}

TEST_F(StructuredIo, LeftHandedGridsAreTurned) {
    HexMesh mirrored = kBox;
    for (Vec3& x : mirrored.points) x.y = -x.y;
    const ReadResult result = read("a.vtk", legacy_text("4 3 5", mirrored));
    EXPECT_THAT(result.warnings, ElementsAre("24 of 24 hexahedra were left-handed (negative Jacobian) and turned round"));
    EXPECT_EQ(inspect(result.mesh).volume, 24);
}

TEST_F(StructuredIo, LegacyErrors) {
    EXPECT_THAT(read_error("a.vtk", legacy_text("4 3 6", kBox)),
                HasSubstr("there are 60 POINTS, but DIMENSIONS says 4 x 3 x 6 points"));
    EXPECT_THAT(read_error("a.vtk", legacy_text("60 1 1", kBox)), HasSubstr("there is no cell between 60 x 1 x 1 points"));
    EXPECT_THAT(read_error("a.vtk", legacy_text("60 1 1", kBox) + "CELL_DATA 59\n"), HasSubstr("there is no cell between"));
    EXPECT_THAT(read_error("a.vtk", legacy_text("4 3 99999999999", kBox)), HasSubstr("count out of range"));
    EXPECT_THAT(read_error("a.vtk", legacy_text("4 3 5", kBox) + "CELLS 1 9\n"),
                HasSubstr("a keyword is expected, not \"CELLS\""));
    EXPECT_THAT(read_error("a.vtk", replaced(legacy_text("4 3 5", kBox), "STRUCTURED_GRID", "FIELD")),
                HasSubstr("DATASET \"FIELD\" is not supported"));
}

}  // namespace structured_io_test

}  // namespace subvol::test
