// SPDX-License-Identifier: Apache-2.0
// fuzz_seeds FOLDER: writes small good inputs, those of each fuzzer into a folder of its name.

#include <array>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <regex>

#include "io/mesh_io/mesh_texts.h"
#include "io/mesh_io/vtu_texts.h"
#include "io/solver_io/exodus_texts.h"
#include "subvol/detail/surface_share.h"
#include "subvol/detail/vtu_bytes.h"
#include "subvol/kernel_file.h"
#include "subvol/mesh_io.h"
#include "subvol/points_io.h"
#include "subvol/refine.h"
#include "subvol/sample.h"
#include "subvol/split.h"
#include "subvol/vtk_grid.h"
#include "subvol/wavelet_file.h"
#include "svw_parts.h"
#include "wavelet_format.h"
#ifdef SUBVOL_FUZZ_VDB
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"
#include "subvol/vdb_points.h"
#endif
#ifdef SUBVOL_FUZZ_COMPARE
#include "subvol/image_io.h"
#endif

namespace subvol::test {

namespace {

class Seeds {
public:
    explicit Seeds(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// The next file of a fuzzer.
    std::filesystem::path path(const std::string& fuzzer, const std::string& extension = "") {
        std::filesystem::create_directories(folder_ / fuzzer);
        return folder_ / fuzzer / ("seed_" + std::to_string(count_++) + extension);
    }
    void add(const std::string& fuzzer, const std::string& text) { std::ofstream(path(fuzzer), std::ios::binary) << text; }

private:
    std::filesystem::path folder_;
    int count_ = 0;
};

HexMesh cube() {
    HexMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    mesh.cells = {{0, 1, 2, 3, 4, 5, 6, 7}};
    mesh.attributes = {{"s", 1, {0, 1, 2, 3, 4, 5, 6, 7}}};
    return mesh;
}

template <class T>
std::string little(const std::vector<T>& values) {
    return bytes_of(values, std::endian::little);
}

void add_binary_meshes(Seeds& seeds, const HexMesh& mesh) {
    std::string nodes, meshb = little<std::int32_t>({1, 2, 3, 20, 3, 4, 256, 8});
    for (std::int32_t p = 0; p < 8; ++p) {
        const Vec3& x = mesh.points[static_cast<std::size_t>(p)];
        nodes += little<std::int32_t>({p + 1}) + little<double>({x.x, x.y, x.z});
        meshb += little<double>({x.x, x.y, x.z}) + little<std::int32_t>({0});
    }
    const std::string corners = little<std::int32_t>({1, 2, 3, 4, 5, 6, 7, 8});
    seeds.add("meshb", meshb + little<std::int32_t>({10, 304, 1}) + corners + little<std::int32_t>({0, 54, 0}));
    seeds.add("gmsh", "$MeshFormat\n2.2 1 8\n" + little<std::int32_t>({1}) + "\n$EndMeshFormat\n$Nodes\n8\n" + nodes +
                          "\n$EndNodes\n$Elements\n1\n" + little<std::int32_t>({5, 1, 0, 1}) + corners + "\n$EndElements\n");
}

void add_exodus(Seeds& seeds, const HexMesh& mesh) {
    const std::vector<double> eight{1, 2, 3, 4, 5, 6, 7, 8};
    const ExodusBlock tet{"TETRA", 4, {1, 2, 4, 5}}, quad{"SHELL4", 4, {1, 2, 3, 4}};
    for (const int version : {1, 2, 5}) {  // what is HDF5 is left to its library
        ExodusText file{.points = mesh.points, .blocks = {hex_block(mesh), tet, quad}, .times = {1}, .version = version};
        file.of_nodes = {{"V_X", eight}, {"V_Y", eight}, {"V_Z", eight}, {"T", eight}};
        file.of_elements = {{"e", {{1}, {2}, {}}}};
        file.old_names = version == 1;
        seeds.add("exodus", exodus_text(file));
    }
}

void add_vtkhdf(Seeds& seeds) {
    const std::string mesh =
        "NumberOfPoints 1 : 8\nNumberOfCells 1 : 1\nNumberOfConnectivityIds 1 : 8\nOffsets 2 : 0 8\nTypes 1 : 12\n"
        "Points 8 3 : 0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\nConnectivity 8 : 0 1 2 3 4 5 6 7\n";
    seeds.add("vtkhdf", mesh + "PointData/T 8 : 1 2 3 4 5 6 7 8\nCellData/c 1 2 : 1 2\n");
    seeds.add("vtkhdf", mesh + "FieldData/patch:p 7 : 8 1 5 0 3 7 4\nCellData/set:s 1 : 1\n");
    seeds.add("vtkhdf", mesh +
                            "PointData/T 16 : 1 2 3 4 5 6 7 8 9\nSteps/Values 2 : 0 1\nSteps/PartOffsets 2 : 0 0\n"
                            "Steps/NumberOfParts 2 : 1 1\nSteps/PointDataOffsets/T 2 : 0 8\nSteps/CellOffsets 2 1 : 0 0\n");
}

void add_amr(Seeds& seeds) {
    seeds.add("vtkhdf",
              "@Origin 3 : 0 0 0\nLevel0/@Spacing 3 : 1 1 1\nLevel0/AMRBox 1 6 : 0 1 0 0 0 0\nLevel0/CellData/c 2 : 1 2\n"
              "Level0/PointData/p 12 : 1 2 3 4 5 6 7 8 9 10 11 12\nLevel1/@Spacing 3 : .5 .5 .5\n"
              "Level1/AMRBox 1 6 : 2 3 0 1 0 1\nLevel1/CellData/c 8 : 1 2 3 4 5 6 7 8\n"
              "Steps/Values 1 : 0\nSteps/Level1/AMRBoxOffset 1 : 0\nSteps/Level1/NumberOfAMRBox 1 : 1\n"
              "Steps/Level1/CellDataOffset/c 1 : 0\n");
}

void add_cgns(Seeds& seeds) {
    const std::string axes =
        "Base/Zone/GridCoordinates GridCoordinates_t\nBase/Zone/GridCoordinates/CoordinateX DataArray_t 8 : 0 1 1 0 0 1 1 0\n"
        "Base/Zone/GridCoordinates/CoordinateY DataArray_t 8 : 0 0 1 1 0 0 1 1\n"
        "Base/Zone/GridCoordinates/CoordinateZ DataArray_t 8 : 0 0 0 0 1 1 1 1.\n";
    const std::string solution =
        "Base/Zone/S FlowSolution_t\nBase/Zone/S/Location GridLocation_t 10 : 'CellCenter\n"
        "Base/Zone/S/Density DataArray_t 1 : 1\n";
    seeds.add("cgns",
              "Base CGNSBase_t 2 : 3 3\nBase/Zone Zone_t 1 3 : 8 1 0\nBase/Zone/ZoneType ZoneType_t 12 : 'Unstructured\n" +
                  axes +
                  "Base/Zone/E Elements_t 2 : 17 0\nBase/Zone/E/ElementRange IndexRange_t 2 : 1 1\n"
                  "Base/Zone/E/ElementConnectivity DataArray_t 8 : 1 2 3 4 5 6 7 8\n" +
                  solution);
    seeds.add("cgns",
              "Base CGNSBase_t 2 : 3 3\nBase/Zone Zone_t 3 3 : 2 2 2 1 1 1 0 0 0\n"
              "Base/Zone/ZoneType ZoneType_t 10 : 'Structured\n" +
                  axes + solution +
                  "Base/Zone/S/Rind Rind_t 6 : 0 0 0 0 0 0\nBase/I BaseIterativeData_t 1 : 2\n"
                  "Base/I/TimeValues DataArray_t 2 : 0 1.5\nBase/Zone/Z ZoneIterativeData_t\n"
                  "Base/Zone/Z/FlowSolutionPointers DataArray_t 2 32 : 'S\n");
}

void add_decks(Seeds& seeds) {
    const std::string nodes = "*NODE, NSET=all\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n";
    const std::string hex = "*ELEMENT, TYPE=C3D8R, ELSET=a\n1,1,2,3,4,5,6,7,8\n";
    seeds.add("inp", nodes + hex + "*ELSET, ELSET=b, GENERATE\n1,1,1\n*STEP\n*END STEP\n");
    seeds.add("inp", "*PART, NAME=p\n" + nodes + hex +
                         "*END PART\n*ASSEMBLY, NAME=a\n*INSTANCE, NAME=i, PART=p\n1,0,0\n1,0,0,1,0,1,90\n*END INSTANCE\n"
                         "*END ASSEMBLY\n");
    seeds.add(
        "inp",
        "*NODE\n1,0,0,0\n5,4,0,0\n*NGEN, NSET=n\n1,5,1\n*NFILL\n*ELGEN, ELSET=e\n1,2,1,1\n*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n");
}

void add_cases(Seeds& seeds) {
    const std::string head = "FoamFile { version 2.0; format ascii; class ";
    seeds.add("foam", "p" + head + "vectorField; }\n8 ((0 0 0) (1 0 0) (2 0 0) (0 1 0) (1 1 0) (2 1 0) (0 0 1) (1 0 1))");
    seeds.add("foam", "f" + head + "faceCompactList; }\n3 (0 4 8)\n8 (1 4 10 7 0 6 9 3)");
    seeds.add("foam", "f" + head + "faceList; }\n2 (4(1 4 10 7) 3(0 6 9))");
    seeds.add("foam", "o" + head + "labelList; }\n11 (0 0 0 0 0 0 1 1 1 1 1)");
    seeds.add("foam", "o" + std::string("FoamFile { format binary; arch \"LSB;label=32;scalar=64\"; class labelList; }\n2\n(") +
                          little<std::int32_t>({0, 1}) + ")");
    seeds.add("foam", "n" + head + "labelList; }\n1 {1}");
    seeds.add(
        "foam",
        "T" + head + "volScalarField; }\ndimensions [0 1 0 0];\ninternalField uniform 3;\nboundaryField { a { type x; } }");
    seeds.add("foam", "U" + head + "volVectorField; }\ninternalField nonuniform List<vector> 2 ((1 2 3) (4 5 6));");
    seeds.add("series",
              "h<VTKFile type=\"vtkOverlappingAMR\"><vtkOverlappingAMR origin=\"0 0 0\"><Block level=\"0\" spacing=\"1 1 1\">"
              "<DataSet amr_box=\"0 0 0 0 0 0\"/></Block><Block level=\"1\" spacing=\".5 .5 .5\">"
              "<DataSet amr_box=\"0 1 0 1 0 1\" file=\"3.vti\"/></Block></vtkOverlappingAMR></VTKFile>");
    seeds.add("series",
              "d<VTKFile><Collection><DataSet timestep=\"0\" part=\"0\" file=\"1.vtu\"/><DataSet timestep=\"1\" "
              "file=\"2.vtu\"/></Collection></VTKFile>");
    seeds.add("series", R"(s{"file-series-version":"1.0","files":[{"name":"1.vtu","time":0},{"name":"2.vtu","time":1}]})");
    seeds.add("series",
              "p<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid GhostLevel=\"1\"><Piece Source=\"1.vtu\"/><Piece "
              "Source=\"2.vtu\"/></PUnstructuredGrid></VTKFile>");
    seeds.add(
        "series",
        "m<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><Block index=\"0\" name=\"a\"><DataSet index=\"0\" "
        "file=\"1.vtu\"/></Block><DataSet index=\"1\" file=\"2.vtu\"/></vtkMultiBlockDataSet></VTKFile>");
}

void add_results(Seeds& seeds, const HexMesh& mesh) {
    std::string nodes = "    2C                             8                                     1\n", values;
    for (std::size_t p = 0; p < 8; ++p) {
        const Vec3& x = mesh.points[p];
        const std::string line = " -1         " + std::to_string(p + 1);
        nodes += line + "    " + std::to_string(x.x) + "    " + std::to_string(x.y) + "    " + std::to_string(x.z) + "\n";
        values += line + " 1.00000E+00\n";
    }
    const std::string step =
        "  100CL  101 1.000000000           8                     0    1           1\n -4  T           1    1\n"
        " -5  T           1    1    0    0\n" +
        values + " -3\n";
    seeds.add("frd", nodes +
                         " -3\n    3C                             1                                     1\n"
                         " -1         1    1    0    1\n -2         1         2         3         4         5         6        "
                         " 7         8\n"
                         " -3\n" +
                         step + step + " 9999\n");
    const std::string grid =
        "<Topology TopologyType=\"Mixed\"><DataItem>9 0 1 2 3 4 5 6 7</DataItem></Topology><Geometry GeometryType=\"XYZ\">"
        "<DataItem Dimensions=\"8 3\">" +
        point_lines(mesh) +
        "</DataItem></Geometry><Attribute Name=\"T\" Center=\"Node\">"
        "<DataItem>1 2 3 4 5 6 7 8</DataItem></Attribute>";
    const std::string run = "<Xdmf><Domain><Grid GridType=\"Collection\" CollectionType=\"Temporal\"><Grid Name=\"a\">";
    seeds.add("xdmf",
              run + grid +
                  "<Time Value=\"1\"/></Grid><Grid><xi:include xpointer=\"xpointer(//Grid[@Name='a']/*[self::Topology])\"/>"
                  "<Topology Reference=\"/Xdmf/Domain/Grid/Grid/Topology\"/></Grid></Grid></Domain></Xdmf>");
    seeds.add("xdmf",
              "<Xdmf><Domain><Grid><Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"2 2 2\"/><Geometry "
              "GeometryType=\"ORIGIN_DXDYDZ\">"
              "<DataItem>0 0 0</DataItem><DataItem>1 1 1</DataItem></Geometry><Attribute Center=\"Node\"><DataItem "
              "ItemType=\"HyperSlab\" "
              "Dimensions=\"8\"><DataItem>0 1 8</DataItem><DataItem Dimensions=\"8\">1 2 3 4 5 6 7 "
              "8</DataItem></DataItem></Attribute>"
              "</Grid></Domain></Xdmf>");
}

/// Without the compression.
void add_wavelets(Seeds& seeds, const HexMesh& mesh) {
    for (const int levels : {1, 2}) {
        const std::filesystem::path file = seeds.path("wavelets", ".svw");
        write_wavelet_file(file, refine(mesh, {.levels = levels}), {.tolerance = .01});
        std::ifstream in(file, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(in), {}};
        std::size_t length = 0, head = detail::kWaveletMagic.size();
        for (int k = 0; k < 8; ++k) length |= std::size_t{static_cast<unsigned char>(bytes[head++])} << 8 * k;
        seeds.add("wavelets",
                  detail::decompressed(detail::Compressor::Lzma, std::string_view(bytes).substr(head), length).value());
        std::filesystem::remove(file);
    }
}

/// Each part as it is in a good file.
void add_steps(Seeds& seeds) {
    SeriesParts small = fuzz::good_steps(), refined = fuzz::refined_steps();
    const std::string index = small.index_of_packed(), index_of_refined = refined.index_of_packed();
    for (const char letter : fuzz::kSeriesParts) {
        const std::string* const part = fuzz::part_of(fuzz::is_of_refined(letter) ? refined : small, letter);
        seeds.add("svw", letter + (letter == 'i' ? index : letter == 'I' ? index_of_refined : *part));
    }
}

void add_plot3d(Seeds& seeds, const HexMesh& mesh) {
    seeds.add("plot3d", "2 2 2\n" + point_lines(mesh));
    seeds.add("plot3d", "2\n2 2 2 2 2 2\n" + point_lines(mesh) + point_lines(mesh) + "1 1 1 1 0 1 1 1\n1 1 1 1 1 1 1 1\n");
    const std::string places = little(coordinates_as<float>(mesh));
    seeds.add("plot3d", little<std::int32_t>({2, 2, 2}) + places);
    seeds.add("plot3d", little<std::int32_t>({12, 2, 2, 2, 12, 96}) + places + little<std::int32_t>({96}));
}

void add_meshes(Seeds& seeds, const HexMesh& mesh) {
    seeds.add("medit", medit_text(mesh));
    seeds.add("medit", "MeshVersionFormatted 2 Dimension 3 Vertices 8 " + point_lines(mesh, " 0") +
                           "Tetrahedra 1 1 2 4 5 0 Prisms 1 1 2 3 5 6 7 0 Pyramids 1 1 2 3 4 5 0 Corners 1 1 End");
    const std::string data = "POINT_DATA 8\nSCALARS s float 1\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8\nVECTORS v double\n" +
                             point_lines(mesh) + "CELL_DATA 1\nFIELD f 2\na 1 1 int\n4\nb 1 1 string\nx\n";
    seeds.add("vtk", vtk_text(mesh) + data);
    seeds.add("vtk", binary_vtk_text(mesh));
    seeds.add("gmsh", gmsh_text(mesh, "2 1 3") +
                          "$NodeData\n1\n\"s\"\n1\n0\n3\n0\n1\n8\n1 1\n2 2\n3 3\n4 4\n5 5\n6 6\n7 7\n8 8\n$EndNodeData\n");
    seeds.add("vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 8 float\n" +
                         point_lines(mesh) + data);
    seeds.add("vtk",
              "# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 2\nX_COORDINATES 2 float\n" +
                  std::string("0 1\nY_COORDINATES 2 float\n0 1\nZ_COORDINATES 2 float\n0 1\n") + data);
    seeds.add("vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\n" +
                         std::string("SPACING 1 1 1\n") + data);
    seeds.add("gmsh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 8 1 8\n3 1 0 8\n1 2 3 4 5 6 7 8\n" + point_lines(mesh) +
                          "$EndNodes\n$Elements\n1 1 1 1\n3 1 5 1\n1 1 2 3 4 5 6 7 8\n$EndElements\n" +
                          "$ElementData\n1\n\"e\"\n0\n3\n0\n1\n1\n1 5\n$EndElementData\n");
    add_binary_meshes(seeds, mesh);
    add_plot3d(seeds, mesh);
    add_wavelets(seeds, mesh);
    add_steps(seeds);
    add_vtkhdf(seeds);
    add_amr(seeds);
    add_cgns(seeds);
    add_decks(seeds);
    add_cases(seeds);
    add_results(seeds, mesh);
    add_exodus(seeds, mesh);
    const std::vector<std::int64_t> patch = vtk_field_arrays(mesh, {{{"p", {{0, 0}}}}, {}}).at(0).numbers;
    const std::vector<std::uint8_t> in_set{1};
    for (const std::string format : {"ascii", "binary", "appended"}) {
        for (const std::string compressor : {"", "vtkZLibDataCompressor", "vtkLZMADataCompressor", "vtkLZ4DataCompressor"}) {
            VtuText vtu{.format = format, .compressor = compressor};
            const std::string fields = "<PointData>" + vtu.array("Float32", "Name=\"s\"", std::vector<float>(8, 1)) +
                                       "</PointData><CellData>" +
                                       vtu.array("Int16", "Name=\"c\"", std::vector<std::int16_t>{1}) + "</CellData>";
            const std::string piece = vtu.piece(mesh, fields);
            seeds.add("vtu", vtu.file(piece + piece));
            seeds.add("vtu",
                      vtu.file("<FieldData>" + vtu.array("Int64", "Name=\"patch:p\"", patch) + "</FieldData>" +
                               vtu.piece(mesh, "<CellData>" + vtu.array("UInt8", "Name=\"set:s\"", in_set) + "</CellData>")));
            const std::string block = "<Piece Extent=\"0 1 0 1 0 1\">" + fields + "<Points>" +
                                      vtu.array("Float64", "NumberOfComponents=\"3\"", coordinates_as<double>(mesh)) +
                                      "</Points></Piece>";
            seeds.add("vts", std::regex_replace(vtu.file(block), std::regex("UnstructuredGrid"), "StructuredGrid"));
            std::string cuts;
            for (int a = 0; a < 3; ++a) cuts += vtu.array("Float32", "Name=\"c\"", std::vector<float>{0, 1});
            const std::string between =
                "<Piece Extent=\"0 1 0 1 0 1\">" + fields + "<Coordinates>" + cuts + "</Coordinates></Piece>";
            seeds.add("vtr", std::regex_replace(vtu.file(between), std::regex("UnstructuredGrid"), "RectilinearGrid"));
            const std::string image = vtu.file("<Piece Extent=\"0 1 0 1 0 1\">" + fields + "</Piece>");
            seeds.add("vti", std::regex_replace(std::regex_replace(image, std::regex("<UnstructuredGrid"),
                                                                   "<ImageData Origin=\"1 2 3\" Spacing=\"1 2 .5\" "
                                                                   "Direction=\"0 1 0 1 0 0 0 0 1\""),
                                                std::regex("UnstructuredGrid"), "ImageData"));
        }
    }
}

void add_points(Seeds& seeds, const HexMesh& mesh) {
    const RbfVolume volume = sample_rbf_points(mesh, {}).volume;
    for (const std::string format : {"ply", "vtp"}) write_points(seeds.path(format, "." + format), volume);
    write_kernel_file(seeds.path("svk", ".svk"), volume);
    seeds.add("kernel", to_json(volume.kernel));
}

/// A tetrahedron as a surface.
void add_surfaces(Seeds& seeds) {
    const std::array<std::array<std::uint32_t, 3>, 4> triangles{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
    const std::array<std::array<float, 3>, 4> points{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    std::string stl(80, ' '), ascii = "solid t\n";
    std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    std::string binary = ply, obj, faces;
    binary.replace(binary.find("ascii"), 5, "binary_little_endian");
    stl += little<std::uint32_t>({4});
    for (const auto& p : points) {
        const std::string row = std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
        obj += "v " + row;
        ply += row;
        binary += little<float>({p[0], p[1], p[2]});
    }
    for (const auto& t : triangles) {
        stl += little<float>({0, 0, 0});
        ascii += "facet normal 0 0 0\nouter loop\n";
        std::string row = "f", corners = "3";
        for (const std::uint32_t c : t) {
            stl += little<float>({points[c][0], points[c][1], points[c][2]});
            ascii += "vertex " + std::to_string(points[c][0]) + " " + std::to_string(points[c][1]) + " " +
                     std::to_string(points[c][2]) + "\n";
            row += " " + std::to_string(c + 1);
            corners += " " + std::to_string(c);
        }
        stl += std::string(2, '\0');
        ascii += "endloop\nendfacet\n";
        obj += row + "\n";
        ply += corners + "\n";
        binary += "\3" + little<std::uint32_t>({t[0], t[1], t[2]});
    }
    seeds.add("stlsurface", stl);
    seeds.add("stlsurface", ascii + "endsolid t\n");
    seeds.add("objsurface", obj);
    seeds.add("objsurface", "o a\nvn 0 0 1\nvt 0 0\n" + obj + "f 1/1/1 2//1 -1 -2\n");
    seeds.add("plysurface", ply);
    seeds.add("plysurface", binary);
}

void add_shares(Seeds& seeds) {
    const HexMesh mesh = make_model("ball", 2);
    for (const int number : {1, 2}) {
        const std::string bytes =
            detail::share_of_surface(mesh, "density", {.isos = {.5}}, {.number = number, .count = 2}).bytes;
        seeds.add("share", bytes);
        const std::filesystem::path file = seeds.path("share", ".svshare");
        detail::write_surface_share(file, {R"({"part":1})", bytes});
        const std::string whole = detail::read_text(file);
        std::filesystem::remove(file);
        seeds.add("share", "f" + whole);
    }
    const std::filesystem::path folder = seeds.path("bricks");
    split_mesh(folder, make_model("ball", 4), {.bricks = 2});
    const std::string index = detail::read_text(folder / "index.json");
    std::filesystem::remove_all(folder);
    seeds.add("bricks", index);
}

/// Files of the components that there are in this build.
void add_of_components(Seeds& seeds) {
    const HexMesh mesh = make_model("ball", 2);
#ifdef SUBVOL_FUZZ_VDB
    const std::vector<std::string> fields{"density"};
    for (const VdbCompression compression : {VdbCompression::None, VdbCompression::Zip, VdbCompression::Blosc}) {
        write_vdb(seeds.path("vdb", ".vdb"), rasterize(mesh, fields, {.voxel_size_world = .3}), compression);
    }
    write_vdb_points(seeds.path("vdb", ".vdb"), sample_rbf_points(mesh, {}).volume);
#endif
#ifdef SUBVOL_FUZZ_COMPARE
    Image image(3, 2);
    for (std::size_t k = 0; k < image.rgba.size(); ++k) image.rgba[k] = static_cast<float>(k) / 24;
    for (const std::string format : {"png", "exr"}) write_image(seeds.path(format, "." + format), image, std::nullopt);
#endif
    static_cast<void>(seeds);
    static_cast<void>(mesh);
}

void add_texts(Seeds& seeds) {
    seeds.add("tables", "x,y,z,T\n0,0,0,1\n1,0,0,2\n# of the third\n0,1,0,3\n");
    seeds.add("tables", "0 0 0 4.5 1e-3\n1\t2\t3\t4\t5\n");
    seeds.add("tables", "T;z;y;x\n1;2;3;4\n");
    for (const std::string region : {"box:-1,-1,-1,0,1,1", "sphere:0,0,0,.7", "half:0,0,0,1,0,0\nset:core", "where:density>.2",
                                     "set:core", "box:0,0,0,1,1,1\nfold:folded,open"}) {
        seeds.add("region", region);
    }
    for (const std::string text :
         {"at:0,0,0", "line:0,0,0,1,1,1", "disk:0,0,0,0,0,1,.5", "sphere:0,0,0,1", "box:0,0,0,1,1,1"}) {
        seeds.add("region", "s" + text);
    }
    seeds.add("study",
              R"({"name":"a","title":"A","inputs":[{"model":"ball","resolution":[4,6]},{"file":"a.vtu","field":"T"}],)"
              R"("cameras":["iso",{"name":"close","camera":"2,-3,1,0,0,0,0,0,1,30"}],)"
              R"("transfer_functions":["viridis",{"name":"s","colors":"coolwarm","opacity":"0%:0,50%:.5"}],"size":[64,64],)"
              R"("methods":[{"method":"splat","samples":[1,2],"label":"s{samples}"},{"method":"dense","step":0.5}],)"
              R"("reference":{"tolerance":1e-3,"max_levels":5},"metrics":["rmse","psnr"],"timed":true,)"
              R"("tables":[{"rows":["input","camera","transfer_function","label"],"columns":["psnr"]}],)"
              R"("plots":[{"x":"seconds","y":"rmse","series":"label","panels":"input","fit":true}],)"
              R"("demands":[{"metric":"psnr","least":40,"where":{"method":"splat"}}]})");
    seeds.add("session", R"([{"orbit":[30,-10]},{"zoom":1.2},{"field":"height"},{"tf":"viridis"},{"pick":[20,20]}])");
    seeds.add("session",
              R"([{"select":[3,4]},{"drag":[1,0,0]},{"undo":true},{"save_state":"a.json"},{"load_state":"a.json"}])");
    seeds.add("session", R"(s{"field":"height","camera":"1,2,3,0,0,0,0,0,1,40","range":[0,1],"size":[48,40],"step":0})");
}

void add_small_files(Seeds& seeds) {
    seeds.add("ensight",
              "ca\nFORMAT\ntype: ensight gold\nGEOMETRY\nmodel: 1 geo\nVARIABLE\nscalar per node: 1 T val\nTIME\ntime set: 1\n"
              "number of steps: 1\nfilename start number: 0\nfilename increment: 1\ntime values: 0.5\n");
    seeds.add("ensight", "ga\nb\nnode id given\nelement id off\nextents\n0 1\n0 1\n0 1\npart\n1\np\nblock iblanked\n2 2 2\n" +
                             std::string("0 1 0 1 0 1 0 1 0 0 1 1 0 0 1 1 0 0 0 0 1 1 1 1 1 1 1 1 1 1 1 1\n"));
    seeds.add("ensight", "vT\npart\n1\ncoordinates undef\n-1\n1 2 3 4 5 6 7 8\n");
    seeds.add(
        "colors",
        R"([{"Name":"a","ColorSpace":"Diverging","RGBPoints":[0,1,0,0,0.5,1,1,1,1,0,0,1],"Points":[0,0,0.5,0,1,1,0.5,0]}])");
    seeds.add("colors", R"({"ColorSpace":"Lab","UseLogScale":0,"RGBPoints":[-1,0,0,0,3,1,1,1]})");
    seeds.add("colors", std::string("\0", 1) + "0:0,0.5:0.2,1:1");
    seeds.add("camera", R"({"eye":[3,2,1],"target":[0,0,0],"up":[0,0,1],"fovy_deg":30,"ortho_height":2})");
    seeds.add("camera", std::string("\0", 1) + "3,2,1,0,0,0,0,0,1,30");
    seeds.add("expression", "sin(3*x)*cos(2*y)+z^2 > 0 ? pi : -1e-3");
    seeds.add("expression", "if(x<y, min(x,y,z), sqrt(abs(x))) && !(z==1)");
}

}  // namespace

}  // namespace subvol::test

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: fuzz_seeds FOLDER\n";
        return 2;
    }
    subvol::test::Seeds seeds(argv[1]);
    subvol::test::add_meshes(seeds, subvol::test::cube());
    subvol::test::add_points(seeds, subvol::test::cube());
    subvol::test::add_surfaces(seeds);
    subvol::test::add_shares(seeds);
    subvol::test::add_texts(seeds);
    subvol::test::add_of_components(seeds);
    subvol::test::add_small_files(seeds);
}
