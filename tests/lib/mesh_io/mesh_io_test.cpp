// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_io.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>

#include <sys/resource.h>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "mesh_texts.h"
#include "subvol/mesh_report.h"
#include "vtu_texts.h"

namespace subvol::test {

namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

// Coordinates that are no short decimals: a round trip must give back every bit.
HexMesh awkward_box() {
    HexMesh mesh = make_box(2, 2, 2);
    for (Vec3& x : mesh.points) x = {x.x / 3 + 1e-17, x.y * std::sqrt(2.0) * 1e6, x.z / 7e9 - 4.9406564584124654e-324};
    return mesh;
}

class MeshIo : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& name, const std::string& text) const {
        return read_mesh(write(name, text));
    }

    [[nodiscard]] std::string read_error(const std::string& name, const std::string& text) const {
        return error_of([&] { static_cast<void>(read(name, text)); });
    }
};

void expect_same_geometry(const HexMesh& a, const HexMesh& b) {
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.cells, b.cells);
}

const HexMesh kBox = make_box(2, 2, 2);

TEST_F(MeshIo, MeditRoundTripKeepsEveryBit) {
    const HexMesh mesh = awkward_box();
    EXPECT_TRUE(write_mesh(path("box.mesh"), mesh).empty());
    const ReadResult back = read_mesh(path("box.mesh"));
    expect_same_geometry(back.mesh, mesh);
    EXPECT_TRUE(back.warnings.empty());
    EXPECT_TRUE(back.fields.empty());
}

TEST_F(MeshIo, ErrorsBeginWithTheFile) {
    EXPECT_THAT(read_error("a.mesh", "OFF"), testing::StartsWith(path("a.mesh").string() + ", line 1: "));
    EXPECT_THAT(read_error("a.vtk", "OFF"), testing::StartsWith(path("a.vtk").string() + ", line 1: "));
}

TEST_F(MeshIo, NonFinitePointsThatNoCellUsesAreIgnored) {
    const auto text = replaced(replaced(medit_text(kBox), "\n27\n", "\n28\n"), "Hexahedra", "nan inf 0 0\nHexahedra");
    EXPECT_EQ(read("a.mesh", text).mesh.points.size(), 28u);
}

TEST_F(MeshIo, LeftHandedCellsAreTurnedAndCounted) {
    HexMesh mirrored = kBox;
    for (std::size_t c = 0; c < 3; ++c)
        std::swap_ranges(mirrored.cells[c].begin(), mirrored.cells[c].begin() + 4, mirrored.cells[c].begin() + 4);
    const ReadResult result = read("a.mesh", medit_text(mirrored));
    EXPECT_EQ(result.mesh.cells, kBox.cells);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("3 of 8 hexahedra were left-handed")));
}

TEST_F(MeshIo, FoldedCellsStayAndAreCounted) {
    HexMesh folded = kBox;
    folded.points[13] = Vec3(1.9);  // the centre close to the far corner: the last cell is concave there
    const ReadResult result = read("a.mesh", medit_text(folded));
    expect_same_geometry(result.mesh, folded);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("1 of 8 hexahedra has a negative Jacobian at a corner")));
}

// ---- legacy VTK

TEST_F(MeshIo, VtkReadsEveryKindOfArray) {
    const HexMesh cell = make_box(1, 1, 1);
    std::string text = vtk_text(cell) +
                       "POINT_DATA 8\nSCALARS s float\nLOOKUP_TABLE mine\n0 1 2 3 4 5 6 7\n"
                       "LOOKUP_TABLE mine 1\n0 0 0 1\n"
                       "SCALARS two double 2\nLOOKUP_TABLE default\n";
    for (int i = 0; i < 16; ++i) text += std::to_string(i) + " ";
    text += "\nVECTORS v float\n";
    for (int i = 0; i < 24; ++i) text += std::to_string(i) + " ";
    text += "\nNORMALS n float\n";
    for (int i = 0; i < 24; ++i) text += "1 ";
    text +=
        "\nMETADATA\nINFORMATION 0\n\nFIELD FieldData 3\na%20b 1 8 int\n7 6 5 4 3 2 1 0\nMETADATA\nINFORMATION 0\n\n"
        "names 1 8 string\none\n\nthree\n4\n5\n6\n7\n8\nlast 1 8 double\n1 1 1 1 1 1 1 -3\n";
    const ReadResult result = read("a.vtk", text);
    ASSERT_EQ(result.fields.size(), 6u);
    EXPECT_EQ(result.mesh.find_attribute("s")->values, (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(result.mesh.find_attribute("two")->channels, 2);
    EXPECT_EQ(result.mesh.find_attribute("v")->values[23], 23);
    EXPECT_EQ(result.mesh.find_attribute("a b")->values[0], 7);
    EXPECT_EQ(result.fields[1].components, 2);
    EXPECT_EQ(result.fields[3].name, "n");
    EXPECT_DOUBLE_EQ(result.fields[3].max, std::sqrt(3.0));  // of vectors, the range of the lengths
    EXPECT_EQ(result.fields[5].min, -3);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("\"names\" ignored")));
}

TEST_F(MeshIo, VtkTakesEveryLineEnd) {
    expect_same_geometry(read("a.vtk", with_crlf(vtk_text(kBox))).mesh, kBox);
}

TEST_F(MeshIo, PointsThatNoCellUsesAreCountedAndCanBeLeftOut) {
    HexMesh mesh = make_box(1, 1, 1);
    mesh.points.insert(mesh.points.begin() + 3, Vec3(50, 0, 0));
    for (Index& corner : mesh.cells[0]) corner += corner >= 3 ? 1 : 0;
    const std::string text = vtk_text(mesh) + "POINT_DATA 9\nSCALARS s float\nLOOKUP_TABLE default\n0 1 2 nan 3 4 5 6 7\n";
    const HexMesh found = read("a.vtk", text).mesh;
    EXPECT_EQ(found.points.size(), 9u);
    EXPECT_EQ(inspect(found).points_used, 8u);
    EXPECT_EQ(inspect(found).bounds.upper, Vec3(1, 1, 1));
    const HexMesh used = without_unused_points(found);
    expect_same_geometry(used, make_box(1, 1, 1));
    EXPECT_THAT(used.find_attribute("s")->values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST_F(MeshIo, VtkVersion5LayoutGivesTheSameCells) {
    std::string text = vtk_text(kBox);
    const auto cells = text.find("CELLS");
    const auto types = text.find("CELL_TYPES");
    text.replace(
        cells, types - cells,
        "CELLS 9 64\nOFFSETS vtktypeint64\n0 8 16 24 32 40 48 56 64\nCONNECTIVITY vtktypeint64\n" + cell_lines(kBox, 0));
    expect_same_geometry(read("a.vtk", text).mesh, kBox);
    EXPECT_THAT(read_error("a.vtk", replaced(text, "48 56 64", "48 56 63")), HasSubstr("the offsets do not end at 64"));
    EXPECT_THAT(read_error("a.vtk", replaced(text, "8 16 24", "8 16 15")), HasSubstr("offset 3 is 15"));
    EXPECT_THAT(read_error("a.vtk", replaced(text, "8 16 24", "8 17 24")), HasSubstr("cell 1 has 9 corners"));
}

TEST_F(MeshIo, VtkVoxelsAreReordered) {
    HexMesh voxels = kBox;
    for (auto& cell : voxels.cells) {
        std::swap(cell[2], cell[3]);
        std::swap(cell[6], cell[7]);
    }
    const ReadResult result = read("a.vtk", vtk_text(voxels, "11"));
    EXPECT_EQ(result.mesh.cells, kBox.cells);
    EXPECT_TRUE(result.warnings.empty());
}

TEST_F(MeshIo, VtkErrorsNameThePlace) {
    const std::string good = vtk_text(kBox) + "POINT_DATA 27\nSCALARS s float 1\nLOOKUP_TABLE default\n" +
                             std::string("0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26\n");
    static_cast<void>(read("good.vtk", good));
    const std::vector<std::array<std::string, 3>> cases{
        {"ASCII", "BINARY", "unexpected end of file"},
        {"ASCII", "EBCDIC", "line 3: encoding: ASCII or BINARY is expected, not \"EBCDIC\""},
        {"UNSTRUCTURED_GRID", "FIELD", "line 4: DATASET \"FIELD\" is not supported"},
        {"UNSTRUCTURED_GRID", "POLYDATA", "line 4: POLYDATA is not a volume mesh"},
        {"27 double", "27 dubble", "line 5: POINTS: a data type is expected, not \"dubble\""},
        {"27 double", "99999999999999 double", "line 5: POINTS: count out of range"},
        {"1 1 1\n", "1 inf 1\n", "line 19: non-finite coordinate at point 13"},
        {"1 1 1\n", "1 1 x\n", "line 19: point 13: a number is expected, not \"x\""},
        {"CELLS 8 72", "CELLS 8 71", "cell 7 does not fit into the 71 numbers"},
        {"CELLS 8 72", "CELLS 8 73", "1 more than its cells have"},
        {"8 13 14 17", "8 13 27 17", "line 41: cell 7: there is no point with index 27"},
        {"8 13 14 17", "8 13 14 13", "cell 7 has point 13 twice, at corners that no collapsed edge joins"},
        {"8 13 14 17", "8 13 -1 17", "line 41: cell 7: there is no point with index -1"},
        {"CELL_TYPES 8", "CELL_TYPES 7", "line 42: there are 7 CELL_TYPES for 8 CELLS"},
        {"POINT_DATA 27", "POINT_DATA 26", "line 51: POINT_DATA is for 26 points, but there are 27"},
        {"POINT_DATA 27", "CELL_DATA 27", "line 51: CELL_DATA is for 27 cells, but there are 8"},
        {" 25 26\n", " 25\n", "array \"s\": value 26: unexpected end of file"},
        {" 25 26\n", " 25 26 27\n", "line 54: a keyword is expected, not \"27\""},
        {" 24 25 26\n", " 24 nan 26\n", "array \"s\": the value at point 25 is not finite"},
        {"POINT_DATA 27\n", "", "SCALARS comes before POINT_DATA or CELL_DATA"},
    };
    for (const auto& [from, to, message] : cases) {
        EXPECT_THAT(read_error("a.vtk", replaced(good, from, to)), HasSubstr(message)) << from << " -> " << to;
    }
}

// Two hexes in a row and a prism on top of the second: volumes 1, 1 and 1/2.
std::string mixed_vtk_text() {
    HexMesh mesh = make_box(2, 1, 1);
    mesh.points.emplace_back(1, 0.5, 2);
    mesh.points.emplace_back(2, 0.5, 2);
    std::string text = replaced(vtk_text(mesh), "CELLS 2 18\n", "CELLS 3 25\n6 7 10 12 8 11 13\n");
    return replaced(text, "\nCELL_TYPES 2\n", "\nCELL_TYPES 3\n13\n");
}

TEST_F(MeshIo, OtherCellsCanBeLeftOutWithTheirValues) {
    const std::string text = mixed_vtk_text() + "CELL_DATA 3\nSCALARS s float\nLOOKUP_TABLE default\nnan 5 5\n";
    const ReadResult result = read_mesh(write("a.vtk", text), {.other_cells = OtherCells::Ignore});
    EXPECT_EQ(result.mesh.cells, make_box(2, 1, 1).cells);
    std::vector<double> expected(14, 5.0);
    expected[12] = expected[13] = 0;  // points of the prism alone
    EXPECT_EQ(result.mesh.find_attribute("s")->values, expected);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("1 wedge (VTK type 13) ignored"), HasSubstr("cell array \"s\"")));
}

TEST_F(MeshIo, OtherCellsCanBeRefused) {
    const auto read_it = [&] {
        static_cast<void>(read_mesh(write("a.vtk", mixed_vtk_text()), {.other_cells = OtherCells::Refuse}));
    };
    EXPECT_THAT(error_of(read_it), HasSubstr("a.vtk: the mesh has 2 hexahedra and 1 prism"));
    static_cast<void>(read_mesh(write("b.vtk", vtk_text(kBox)), {.other_cells = OtherCells::Refuse}));
}

TEST_F(MeshIo, OtherCellsAreSplitWithTheirValues) {
    const ReadResult result = read("a.vtk", mixed_vtk_text() +
                                                "CELL_DATA 3\nSCALARS s float\nLOOKUP_TABLE default\n10 20 30\n"
                                                "POINT_DATA 14\nSCALARS x float\nLOOKUP_TABLE default\n"
                                                "0 1 2 0 1 2 0 1 2 0 1 2 1 2\n");
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("2 hexahedra and 1 prism split into 22 hexahedra"), HasSubstr("\"s\"")));
    const auto& s = result.mesh.find_attribute("s")->values;
    const auto& x = result.mesh.find_attribute("x")->values;
    ASSERT_EQ(s.size(), result.mesh.points.size());
    for (std::size_t p = 0; p < s.size(); ++p) {
        const Vec3 at = result.mesh.points[p];
        EXPECT_DOUBLE_EQ(x[p], at.x);  // means keep what is linear
        // Inside a cell and on the hull the cell's own value; between the hexes, whose children are equal, the mean.
        if (at.z == 1) continue;
        EXPECT_DOUBLE_EQ(s[p], at.z > 1 ? 10 : at.x < 1 ? 20 : at.x > 1 ? 30 : 25);
    }
}

TEST_F(MeshIo, CellArraysBecomeVolumeWeightedMeans) {
    HexMesh mesh = make_box(2, 1, 1);
    for (Vec3& x : mesh.points) {
        if (x.x == 2) x.x = 4;  // volumes 1 and 3
    }
    const ReadResult result = read("a.vtk", vtk_text(mesh) +
                                                "CELL_DATA 2\nSCALARS s float\nLOOKUP_TABLE default\n10 20\n"
                                                "VECTORS v float\n1 0 0  0 1 0\n");
    const auto& s = result.mesh.find_attribute("s")->values;
    const auto& v = result.mesh.find_attribute("v")->values;
    constexpr double kRounding = 1e-14;  // the Gauss volumes are exact but for rounding
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const double x = mesh.points[p].x;
        const double far = x == 0 ? 0.0 : x == 1 ? 0.75 : 1.0;  // the weight of the second cell
        EXPECT_NEAR(s[p], 10 + 10 * far, 20 * kRounding);
        EXPECT_NEAR(v[3 * p], 1 - far, kRounding);
        EXPECT_NEAR(v[3 * p + 1], far, kRounding);
    }
    EXPECT_EQ(result.fields[0].location, "cell");
    EXPECT_EQ(result.fields[0].min, 10);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("2 cell arrays became point arrays (\"s\", \"v\")")));
}

TEST_F(MeshIo, CellArraysOfFoldedCellsStayInTheirRange) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        HexMesh folded = make_box(2, 1, 1);
        folded.points.emplace_back(1, 0.5, 2);
        folded.points.emplace_back(2, 0.5, 2);
        jitter(folded, 0.9, seed);
        std::string text = replaced(vtk_text(folded), "CELLS 2 18\n", "CELLS 3 25\n6 7 10 12 8 11 13\n");
        text =
            replaced(text, "\nCELL_TYPES 2\n", "\nCELL_TYPES 3\n13\n") + "CELL_DATA 3\nSCALARS s float\nLOOKUP_TABLE default\n";
        const ReadResult result = read("a.vtk", text + "10 20 30\n");
        for (const double value : result.mesh.find_attribute("s")->values) {
            ASSERT_GE(value, 10 - 1e-12) << seed;  // rounding
            ASSERT_LE(value, 30 + 1e-12) << seed;
        }
    }
}

TEST_F(MeshIo, VtkCellsMayHaveMorePointsThanTheirTypesCorners) {
    struct Case {
        int type;
        std::size_t corners;
        std::vector<std::size_t> points;
        double volume;
    };
    // Each shape by the first corners of a unit cube, in their order.
    const std::array<Vec3, 8> cube{Vec3{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    const std::vector<Case> cases{
        {10, 4, {10}, 1. / 6}, {12, 8, {20, 24, 27}, 1}, {13, 6, {12, 15, 18}, .5}, {14, 5, {13, 19}, 1. / 3}};
    const auto text_of = [&](const Case& c, std::size_t points) {
        std::vector<std::size_t> corners{0, 1, 2, 3, 4, 5, 6, 7};
        if (c.corners == 4) corners = {0, 1, 2, 5};
        if (c.corners == 6) corners = {0, 1, 2, 4, 5, 6};
        HexMesh mesh;
        for (std::size_t k = 0; k < points; ++k) mesh.points.push_back(k < c.corners ? cube[corners[k]] : Vec3(.5));
        std::string text = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
                           std::to_string(points) + " double\n" + point_lines(mesh) + "CELLS 1 " + std::to_string(points + 1) +
                           "\n" + std::to_string(points);
        for (std::size_t k = 0; k < points; ++k) text += " " + std::to_string(k);
        return text + "\nCELL_TYPES 1\n" + std::to_string(c.type) + "\n";
    };
    for (const Case& c : cases) {
        for (const std::size_t points : c.points) {
            const ReadResult result = read_mesh(write("a.vtk", text_of(c, points)), {.curved_tolerance = std::nullopt});
            EXPECT_NEAR(inspect(result.mesh).volume, c.volume, 1e-14) << c.type << " with " << points;
            EXPECT_THAT(result.warnings, Contains(HasSubstr("1 cell has more points than corners: only the corners are used")));
        }
        const std::string corners = std::to_string(c.corners + 3) + " corners";
        EXPECT_THAT(read_error("a.vtk", text_of(c, c.corners + 3)), HasSubstr("cell 0 has " + corners));
    }
}

TEST_F(MeshIo, CellsWithoutVolumeCountTheSame) {
    HexMesh flat = make_box(2, 1, 1);
    for (Vec3& x : flat.points) x.z = 0;
    const auto result = read("a.vtk", vtk_text(flat) + "CELL_DATA 2\nSCALARS s float\nLOOKUP_TABLE default\n10 20\n");
    EXPECT_EQ(result.mesh.find_attribute("s")->values[1], 15);
}

TEST_F(MeshIo, ArraysOfOneNameAreToldApart) {
    const auto result = read("a.vtk", vtk_text(make_box(1, 1, 1)) +
                                          "POINT_DATA 8\nSCALARS s int\nLOOKUP_TABLE default\n1 1 1 1 1 1 1 1\n"
                                          "CELL_DATA 1\nSCALARS s int\nLOOKUP_TABLE default\n2\n");
    EXPECT_EQ(result.mesh.find_attribute("s")->values[0], 1);
    EXPECT_EQ(result.mesh.find_attribute("s_2")->values[0], 2);
}

TEST_F(MeshIo, NonFiniteValuesCountOnlyAtUsedPoints) {
    HexMesh mesh = make_box(1, 1, 1);
    mesh.points.emplace_back(9, 9, 9);
    const std::string text = vtk_text(mesh) + "POINT_DATA 9\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8 nan\n";
    const auto result = read("a.vtk", text);
    EXPECT_EQ(result.fields[0].max, 8);
    EXPECT_THAT(read_error("a.vtk", replaced(text, "8 nan", "1e999 0")), HasSubstr("the value at point 7 is not finite"));
    EXPECT_THAT(read_error("a.vtk", vtk_text(mesh) + "CELL_DATA 1\nSCALARS s float\nLOOKUP_TABLE default\n-inf\n"),
                HasSubstr("array \"s\": the value at cell 0 is not finite"));
}

TEST_F(MeshIo, NamesInLatin1BecomeUtf8) {
    const auto result = read("a.vtk", vtk_text(make_box(1, 1, 1)) +
                                          "POINT_DATA 8\nSCALARS d\xE9"
                                          "bit int\nLOOKUP_TABLE default\n1 1 1 1 1 1 1 1\n");
    EXPECT_EQ(result.fields[0].name,
              "d\xC3\xA9"
              "bit");
}

// ---- writers, files

// The values of an array that a file holds as base64, compressed by zlib in one block.
template <class T>
std::vector<T> compressed(const std::string& file, const std::string& name) {
    const auto array = file.find("Name=\"" + name + "\"");
    const auto begin = file.find('\n', array) + 1;
    const std::string text = file.substr(begin, file.find('\n', begin) - begin);
    constexpr std::size_t kHeader = 44;  // four numbers of 8 bytes
    std::array<std::uint64_t, 4> header{};
    const std::string numbers = from_base64(text.substr(0, kHeader)), data = from_base64(text.substr(kHeader));
    std::memcpy(header.data(), numbers.data(), sizeof header);
    EXPECT_EQ(header[0], 1u);
    EXPECT_EQ(header[3], data.size());
    std::vector<T> values(header[2] / sizeof(T));
    uLongf size = header[2];
    EXPECT_EQ(
        uncompress(reinterpret_cast<Bytef*>(values.data()), &size, reinterpret_cast<const Bytef*>(data.data()), data.size()),
        Z_OK);
    EXPECT_EQ(size, header[2]);
    return values;
}

TEST_F(MeshIo, VtuHoldsTheMeshToTheBit) {
    HexMesh mesh = awkward_box();
    mesh.attributes.push_back({"a<\"b\">", 1, std::vector<double>(27, 1.0 / 3)});
    mesh.attributes.push_back({"velocity", 3, std::vector<double>(81, -0.1)});
    EXPECT_TRUE(write_mesh(path("box.vtu"), mesh).empty());
    const std::string file = read_bytes(path("box.vtu"));
    EXPECT_THAT(file, HasSubstr("NumberOfPoints=\"27\" NumberOfCells=\"8\""));
    EXPECT_THAT(file, HasSubstr("Name=\"velocity\" NumberOfComponents=\"3\""));
    const auto points = compressed<Vec3>(file, "Points");
    EXPECT_EQ(points, mesh.points);
    const auto connectivity = compressed<std::int64_t>(file, "connectivity");
    ASSERT_EQ(connectivity.size(), 64u);
    for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(connectivity[i], mesh.cells[i / 8][i % 8]);
    EXPECT_THAT(compressed<std::int64_t>(file, "offsets"), ElementsAre(8, 16, 24, 32, 40, 48, 56, 64));
    EXPECT_EQ(compressed<std::uint8_t>(file, "types"), std::vector<std::uint8_t>(8, 12));
    EXPECT_EQ(compressed<double>(file, "a&lt;&quot;b&quot;&gt;"), mesh.attributes[0].values);
    EXPECT_EQ(compressed<double>(file, "velocity"), mesh.attributes[1].values);
}

TEST_F(MeshIo, AWarningListsWhatAFormatCannotHold) {
    HexMesh mesh = kBox;
    mesh.attributes.push_back({"density", 1, std::vector<double>(27)});
    mesh.creases.push_back({0, 1});
    EXPECT_THAT(write_mesh(path("a.mesh"), mesh), ElementsAre(HasSubstr("\"density\""), HasSubstr("1 crease written as")));
    EXPECT_THAT(write_mesh(path("a.vtu"), mesh), ElementsAre(HasSubstr("1 crease not written")));
}

TEST_F(MeshIo, UnknownFormatsAndMissingFilesAreRefused) {
    EXPECT_THAT(
        error_of([&] { static_cast<void>(read_mesh(path("a.obj"))); }),
        HasSubstr(
            "\".obj\" files cannot be read (.mesh, .meshb: MEDIT; .vtk: legacy VTK; .vtu, .vts, .vtr, .vti, .pvtu, .pvts, "
            ".pvtr, .pvti, .vtm: VTK XML; .pvd, .series: ParaView; .msh: Gmsh; .xyz, .p3d: Plot3D; .e, .exo, .ex2, .g: "
            "Exodus II; .vtkhdf, .hdf: VTKHDF; .xdmf, .xmf: XDMF; .frd: CalculiX; .cgns: CGNS; .case: "
            "EnSight Gold; .foam, .openfoam: OpenFOAM; .inp: Abaqus)"));
    EXPECT_THAT(error_of([&] { write_mesh(path("a.vtk"), kBox); }),
                HasSubstr("\".vtk\" files cannot be written (.mesh: MEDIT; .vtu: VTK XML)"));
    const auto missing = [&] { static_cast<void>(read_mesh(path("none.mesh"))); };
    EXPECT_THAT(error_of(missing, ErrorCode::Io), HasSubstr("none.mesh: cannot be read: No such file"));
    std::filesystem::create_directory(path("folder.mesh"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("folder.mesh"))); }, ErrorCode::Io), HasSubstr("directory"));
    EXPECT_THAT(error_of([&] { write_mesh(path("no/a.vtu"), kBox); }, ErrorCode::Io), HasSubstr("does not exist"));
}

TEST_F(MeshIo, ListedExtensionsAreThoseThatAreReadAndWritten) {
    for (const std::string& extension : readable_mesh_extensions()) {
        const auto missing = [&] { static_cast<void>(read_mesh(path("none" + extension))); };
        EXPECT_THAT(error_of(missing, ErrorCode::Io), HasSubstr("cannot be read: No such file"));
    }
    for (const std::string& extension : writable_mesh_extensions()) {
        write_mesh(path("a" + extension), kBox);
        EXPECT_EQ(read_mesh(path("a" + extension)).mesh.cells, kBox.cells);
    }
    EXPECT_THAT(readable_mesh_extensions(), testing::Contains(".exo"));
    EXPECT_THAT(writable_mesh_extensions(), ElementsAre(".mesh", ".vtu"));
}

TEST_F(MeshIo, MeshesThatAreNotSoundAreNotWritten) {
    HexMesh mesh = kBox;
    mesh.cells[3][0] = 99;
    EXPECT_THAT(error_of([&] { write_mesh(path("a.vtu"), mesh); }), HasSubstr("cell 3"));
    EXPECT_EQ(file_count(), 0u);
}

// Simulates a full disk: limits the size of files.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
    void (*handler_)(int);
    rlimit before_{};
};

TEST_F(MeshIo, AFullDiskIsAnErrorAndLeavesNothing) {
    for (const std::string name : {"a.mesh", "a.vtu"}) {
        for (const rlim_t bytes : {rlim_t{0}, rlim_t{100}, rlim_t{20000}}) {
            const FileSizeLimit limit(bytes);
            const auto write = [&] { write_mesh(path(name), make_box(12, 12, 12)); };
            EXPECT_THAT(error_of(write, ErrorCode::Io), HasSubstr(name + ": cannot be written"));
            EXPECT_EQ(file_count(), 0u);
        }
    }
}

}  // namespace

}  // namespace subvol::test
