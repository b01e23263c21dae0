// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "lib/test_meshes.h"
#include "mesh_damage.h"
#include "mesh_texts.h"
#include "subvol/vtk_grid.h"
#include "vtu_texts.h"

namespace subvol::test {

namespace mesh_fuzz_test {

TEST_F(MeshFuzz, Medit) {
    const std::string text = "# c\n" + medit_text(make_box(2, 2, 2)) + "Tetrahedra 1\n1 2 3 4 0\nCorners 1\n1\n";
    expect_sound_or_refused(".mesh", replaced(text, "End\n", ""), 1);
}

TEST_F(MeshFuzz, VtkCountedCells) {
    std::string text = vtk_text(make_box(2, 2, 1)) +
                       "METADATA\nINFORMATION 0\n\nPOINT_DATA 18\nSCALARS s%20t double 1\n"
                       "LOOKUP_TABLE t\n1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9\nLOOKUP_TABLE t 1\n"
                       "0 0 0 1\nCELL_DATA 4\nFIELD f 2\na 1 4 int\n1 2 3 4\nb 1 4 string\n1\n\n3\n4\n";
    expect_sound_or_refused(".vtk", text, 2);
}

TEST_F(MeshFuzz, QuadsAndLinesBesideHexahedra) {
    HexMesh mesh = make_box(1, 1, 1);
    for (const Vec3& p : {Vec3(0, 0, 2), Vec3(1, 0, 2), Vec3(2, 0, 3)}) mesh.points.push_back(p);
    const std::string text = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 11 double\n" +
                             point_lines(mesh) + "CELLS 4 22\n4 4 5 9 8\n" + cell_lines(mesh, 0, "8 ") +
                             "2 9 10\n4 0 1 3 2\nCELL_TYPES 4\n9\n12\n3\n9\nPOINT_DATA 11\nSCALARS p double\n" +
                             "LOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10\nCELL_DATA 4\nVECTORS v float\n" +
                             "1 2 3 4 5 6 7 8 9 1 2 3\n";
    expect_sound_or_refused(".vtk", text, 43);
    std::string gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n11\n";
    for (std::size_t p = 0; p < 11; ++p) {
        gmsh += std::to_string(p + 1) + " " + number(mesh.points[p].x) + " " + number(mesh.points[p].y) + " " +
                number(mesh.points[p].z) + "\n";
    }
    gmsh += "$EndNodes\n$Elements\n3\n" + cell_lines(mesh, 1, "1 5 0 ") + "2 3 0 5 6 10 9\n3 1 0 10 11\n$EndElements\n" +
            "$ElementData\n1\n\"e\"\n1\n0.0\n3\n0\n1\n2\n1 1.5\n2 2.5\n$EndElementData\n";
    expect_sound_or_refused(".msh", gmsh, 44);
}

TEST_F(MeshFuzz, VtkOffsetsAndConnectivity) {
    const HexMesh mesh = make_box(2, 1, 1);
    const std::string text = "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n" +
                             point_lines(mesh) + "CELLS 4 20\nOFFSETS vtktypeint64\n0 8 16 20\nCONNECTIVITY vtktypeint64\n" +
                             cell_lines(mesh, 0) + "0 1 2 3\nCELL_TYPES 3\n12\n12\n10\nCELL_DATA 3\nVECTORS v float\n" +
                             "1 2 3 4 5 6 7 8 9\n";
    expect_sound_or_refused(".vtk", text, 3);
}

TEST_F(MeshFuzz, VtkBinary) {
    const std::string eight = bytes_of(std::vector<double>(12, 0.5), std::endian::big);
    const std::string text = binary_vtk_text(make_box(2, 1, 1)) + "METADATA\nINFORMATION 0\n\nPOINT_DATA 12\nFIELD f 3\n" +
                             "a 1 12 double\n" + eight + "\nb 1 12 bit\nab\nc 1 2 string\n\xC1x\x80\x02yz\n" +
                             "COLOR_SCALARS r 1\n0123456789ab\nCELL_DATA 2\nSCALARS s short\nLOOKUP_TABLE default\nabcd\n";
    expect_sound_or_refused(".vtk", text, 4);
}

TEST_F(MeshFuzz, VtkBinaryOffsetsAndConnectivity) {
    const HexMesh mesh = make_box(2, 1, 1);
    std::vector<std::int64_t> corners = corners_as<std::int64_t>(mesh);
    corners.insert(corners.end(), {0, 1, 3, 6});
    const auto big = [](const auto& values) { return bytes_of(values, std::endian::big); };
    const std::string text = "# vtk DataFile Version 5.1\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n" +
                             big(coordinates_as<double>(mesh)) + "\nCELLS 4 20\nOFFSETS vtktypeint64\n" +
                             big(std::vector<std::int64_t>{0, 8, 16, 20}) + "\nCONNECTIVITY vtktypeint64\n" + big(corners) +
                             "\nCELL_TYPES 3\n" + big(std::vector<std::int32_t>{12, 12, 10}) + "\n";
    expect_sound_or_refused(".vtk", text, 5);
}

TEST_F(MeshFuzz, VtuOfEveryEncoding) {
    unsigned seed = 6;
    for (const auto& [format, encoding] : std::vector<std::pair<std::string, std::string>>{
             {"ascii", ""}, {"binary", ""}, {"appended", "raw"}, {"appended", "base64"}}) {
        for (const std::string compressor : {"", "vtkZLibDataCompressor", "vtkLZMADataCompressor", "vtkLZ4DataCompressor"}) {
            if (format == "ascii" && !compressor.empty()) continue;
            VtuText vtu{.format = format, .encoding = encoding, .compressor = compressor};
            const std::string data = "<PointData>" + vtu.array("Float32", "Name=\"s\"", std::vector<float>(8, 1)) +
                                     "</PointData><CellData>" + vtu.array("Int16", "Name=\"c\"", std::vector<std::int16_t>{1}) +
                                     "</CellData>";
            const std::string piece = vtu.piece(make_box(1, 1, 1), data);
            expect_sound_or_refused(".vtu", vtu.file(piece + piece), seed++);
        }
    }
}

TEST_F(MeshFuzz, PatchesAndSetsOfVtu) {
    const HexMesh mesh = make_box(2, 1, 1);
    const auto file = path("good.vtu");
    std::ignore = write_mesh(file, mesh, {}, {{{"p", {{0, 0}, {0, 2}}}, {"q", {{1, 1}}}}, {{"s", {1}}}});
    std::string text = read_bytes(file);
    expect_sound_or_refused(".vtu", text, 45);
    VtuText vtu;  // as text, so that damage changes single numbers
    const std::string begin =
        "<FieldData>" + vtu.array("Int64", "Name=\"patch:p\"", vtk_field_arrays(mesh, {{{"p", {{0, 0}}}}, {}})[0].numbers) +
        "</FieldData>";
    const std::string data =
        "<CellData>" + vtu.array("UInt8", "Name=\"set:s\"", std::vector<std::int64_t>{0, 1}) + "</CellData>";
    text = vtu.file(begin + vtu.piece(mesh, data));
    EXPECT_EQ(read_mesh(write("good.vtu", text)).sets.patches.size(), 1u);
    expect_sound_or_refused(".vtu", text, 46);
}

TEST_F(MeshFuzz, Gmsh) {
    const std::string text =
        replaced(gmsh_text(make_box(2, 1, 1), "2 1 3"), "$Elements\n2\n", "$Elements\n4\n1 4 0 1 2 4 7\n2 3 0 1 2 3 4\n") +
        "$NodeData\n1\n\"s\"\n1\n0\n3\n0\n1\n12\n1 1\n2 2\n3 3\n4 4\n5 5\n6 6\n7 7\n8 8\n9 9\n"
        "10 1\n11 1\n12 1\n$EndNodeData\n";
    expect_sound_or_refused(".msh", text, 30);
}

std::string little_integers(const std::vector<std::int32_t>& values) {
    return bytes_of(values, std::endian::little);
}

TEST_F(MeshFuzz, MeditBinary) {
    const HexMesh mesh = make_box(1, 1, 1);
    std::string text = little_integers({1, 2, 3, 20, 3, 4, 256, 8});
    for (const Vec3& x : mesh.points) {
        text += bytes_of(std::vector<double>{x.x, x.y, x.z}, std::endian::little) + little_integers({0});
    }
    text += little_integers({10, 304, 1}) + little_integers({1, 2, 4, 3, 5, 6, 8, 7, 0});
    text += little_integers({8, 336, 1, 1, 2, 3, 5, 0, 54, 0});
    expect_sound_or_refused(".meshb", text, 33);
}

TEST_F(MeshFuzz, GmshBinary) {
    const HexMesh mesh = make_box(1, 1, 1);
    std::string nodes;
    for (std::size_t p = 0; p < 8; ++p) {
        const Vec3& x = mesh.points[p];
        nodes += little_integers({static_cast<std::int32_t>(p + 1)}) +
                 bytes_of(std::vector<double>{x.x, x.y, x.z}, std::endian::little);
    }
    const std::string text = "$MeshFormat\n2.2 1 8\n" + little_integers({1}) + "\n$EndMeshFormat\n$Nodes\n8\n" + nodes +
                             "\n$EndNodes\n$Elements\n2\n" + little_integers({5, 1, 0, 1, 1, 2, 4, 3, 5, 6, 8, 7}) +
                             little_integers({4, 1, 0, 2, 1, 2, 3, 5}) + "\n$EndElements\n";
    expect_sound_or_refused(".msh", text, 34);
}

TEST_F(MeshFuzz, GmshBlocks) {
    const std::string places = point_lines(make_box(1, 1, 1));
    expect_sound_or_refused(
        ".msh",
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 8 1 8\n3 1 0 8\n1 2 3 4 5 6 7 8\n" + places +
            "$EndNodes\n$Elements\n2 2 1 2\n3 1 5 1\n1 1 2 4 3 5 6 8 7\n3 1 4 1\n2 1 2 3 5\n$EndElements\n" +
            "$ElementData\n1\n\"e\"\n0\n3\n0\n1\n1\n1 5\n$EndElementData\n",
        35);
}

TEST_F(MeshFuzz, Plot3d) {
    const HexMesh mesh = make_box(2, 1, 1);
    const std::string places = bytes_of(coordinates_as<float>(mesh), std::endian::big);
    const auto size = bytes_of(std::vector<std::int32_t>{12}, std::endian::big);
    const auto length = bytes_of(std::vector{static_cast<std::int32_t>(places.size())}, std::endian::big);
    const auto sizes = bytes_of(std::vector<std::int32_t>{3, 2, 2}, std::endian::big);
    expect_sound_or_refused(".p3d", size + sizes + size + length + places + length, 36);
    expect_sound_or_refused(".xyz", "2\n3 2 2 3 2 2\n" + point_lines(mesh) + point_lines(mesh), 37);
}

std::string as_type(std::string text, const std::string& type, const std::string& attributes = "") {
    const std::string unstructured = "UnstructuredGrid";
    for (std::size_t at = 0; (at = text.find(unstructured)) != std::string::npos;) text.replace(at, unstructured.size(), type);
    return replaced(text, "<" + type + ">", "<" + type + attributes + ">");
}

TEST_F(MeshFuzz, VtkXmlBlocks) {
    for (VtuText vtu : {VtuText{.format = "ascii"}, VtuText{.format = "appended", .compressor = "vtkZLibDataCompressor"}}) {
        const std::string data = "<PointData>" + vtu.array("Float32", "Name=\"s\"", std::vector<float>(12, 1)) + "</PointData>";
        const std::string piece = "<Piece Extent=\"0 2 0 1 0 1\">" + data;
        const auto array = [&](const std::vector<float>& values, const std::string& attributes = "") {
            return vtu.array("Float32", attributes, values);
        };
        const std::string places = array(coordinates_as<float>(make_box(2, 1, 1)), "NumberOfComponents=\"3\"");
        const std::string cuts = array({0, 1, 2}) + array({0, 1}) + array({0, 1});
        const auto grid = [&](const std::string& type, const std::string& rest, const std::string& attributes = "") {
            return as_type(vtu.file(piece + rest + "</Piece>"), type, attributes);
        };
        expect_sound_or_refused(".vts", grid("StructuredGrid", "<Points>" + places + "</Points>"), 38);
        expect_sound_or_refused(".vtr", grid("RectilinearGrid", "<Coordinates>" + cuts + "</Coordinates>"), 39);
        expect_sound_or_refused(".vti", grid("ImageData", "", " Origin=\"0 1 2\" Spacing=\"1 2 .5\""), 40);
    }
}

TEST_F(MeshFuzz, VtkBlocks) {
    const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET ";
    const std::string data = "POINT_DATA 12\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8 9 1 2 3\n";
    expect_sound_or_refused(
        ".vtk", head + "STRUCTURED_GRID\nDIMENSIONS 3 2 2\nPOINTS 12 float\n" + point_lines(make_box(2, 1, 1)) + data, 41);
    expect_sound_or_refused(".vtk",
                            head + "RECTILINEAR_GRID\nDIMENSIONS 3 2 2\nX_COORDINATES 3 float\n0 1 2\nY_COORDINATES 2 float\n" +
                                "0 1\nZ_COORDINATES 2 float\n0 1\n" + data,
                            42);
    expect_sound_or_refused(".vtk", head + "STRUCTURED_POINTS\nDIMENSIONS 3 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\n" + data, 43);
}

TEST_F(MeshFuzz, MixedCells) {
    const std::string cells = "Pyramids 1\n1 2 7 6 4 0\nPrisms 1\n1 2 3 6 7 8 0\nTetrahedra 1\n1 2 3 5 0\nHexahedra 0\n";
    const std::string vertices = "Vertices 8\n0 0 0 0\n1 0 0 0\n0 1 0 0\n.5 -1 .5 0\n0 0 -1 0\n0 0 1 0\n1 0 1 0\n0 1 1 0\n";
    expect_sound_or_refused(".mesh", "MeshVersionFormatted 2\nDimension 3\n" + vertices + cells, 31);
    expect_sound_or_refused(".mesh", "MeshVersionFormatted 2\nDimension 3\n" + cells + vertices, 32);
}

}  // namespace mesh_fuzz_test

}  // namespace subvol::test
