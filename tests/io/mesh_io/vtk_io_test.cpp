// SPDX-License-Identifier: Apache-2.0
// Legacy VTK; and what arrays and cells of all kinds become, for which it is the plainest text.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <tuple>

#include "lib/test_meshes.h"
#include "mesh_files.h"
#include "mesh_texts.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace vtk_io_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class VtkIo : public MeshFiles {};

const HexMesh kBox = make_box(2, 2, 2);

TEST_F(VtkIo, ReadsEveryKindOfArray) {
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

// Bytes from 0 to 255 are those of BINARY files alone.
TEST_F(VtkIo, ColoursInTextsAreRealNumbers) {
    const std::string text = vtk_text(make_box(1, 1, 1)) +
                             "POINT_DATA 8\nSCALARS s float\nLOOKUP_TABLE mine\n0 1 2 3 4 5 6 7\n"
                             "LOOKUP_TABLE mine 2\n1.0 0.4 0.0 0.5\n0 .25 1 1\n"
                             "COLOR_SCALARS rgb 1\n0 .125 .25 .375 .5 .625 .75 1\n";
    const ReadResult result = read("a.vtk", text);
    EXPECT_EQ(result.mesh.find_attribute("s")->values[7], 7);
    EXPECT_EQ(result.mesh.find_attribute("rgb")->values, (std::vector<double>{0, .125, .25, .375, .5, .625, .75, 1}));
}

// FreeFem's writer: keywords in mixed case, and the number of components at the type.
TEST_F(VtkIo, TheNumberOfComponentsMayTouchTheType) {
    const std::string text =
        vtk_text(make_box(2, 1, 1)) + "CELL_DATA 2\nScalars  Label int1\nLOOKUP_TABLE FreeFempp_table\n3\n8\n";
    const ReadResult result = read("a.vtk", text);
    ASSERT_NE(result.mesh.find_attribute("Label"), nullptr);
    EXPECT_EQ(result.mesh.find_attribute("Label")->cells, (std::vector<double>{3, 8}));
    EXPECT_THAT(read_error("a.vtk", vtk_text(make_box(2, 1, 1)) + "CELL_DATA 2\nSCALARS Label int2\nLOOKUP_TABLE t\n3\n8\n"),
                HasSubstr("a data type is expected, not \"int2\""));
}

TEST_F(VtkIo, TakesEveryLineEnd) {
    expect_same_geometry(read("a.vtk", with_crlf(vtk_text(kBox))).mesh, kBox);
}

TEST_F(VtkIo, PointsThatNoCellUsesAreCountedAndCanBeLeftOut) {
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

TEST_F(VtkIo, Version5LayoutGivesTheSameCells) {
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

TEST_F(VtkIo, VoxelsAreReordered) {
    HexMesh voxels = kBox;
    for (auto& cell : voxels.cells) {
        std::swap(cell[2], cell[3]);
        std::swap(cell[6], cell[7]);
    }
    const ReadResult result = read("a.vtk", vtk_text(voxels, "11"));
    EXPECT_EQ(result.mesh.cells, kBox.cells);
    EXPECT_TRUE(result.warnings.empty());
}

TEST_F(VtkIo, ErrorsNameThePlace) {
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
        {" 25 26\n", " 25\n", "array \"s\": value 26: unexpected end of file"},
        {" 25 26\n", " 25 26 27\n", "line 54: a keyword is expected, not \"27\""},
        {"POINT_DATA 27", "POINT_DATA 26", "line 51: POINT_DATA is for 26 points, but there are 27"},
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

TEST_F(VtkIo, OtherCellsCanBeLeftOutWithTheirValues) {
    const std::string text = mixed_vtk_text() + "CELL_DATA 3\nSCALARS s float\nLOOKUP_TABLE default\nnan 5 5\n";
    const ReadResult result = read_mesh(write("a.vtk", text), {.other_cells = OtherCells::Ignore});
    EXPECT_EQ(result.mesh.cells, make_box(2, 1, 1).cells);
    std::vector<double> expected(14, 5.0);
    expected[12] = expected[13] = 0;  // points of the prism alone
    EXPECT_EQ(result.mesh.find_attribute("s")->values, expected);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("1 wedge (VTK type 13) ignored"), HasSubstr("cell array \"s\"")));
}

TEST_F(VtkIo, OtherCellsCanBeRefused) {
    const auto read_it = [&] {
        static_cast<void>(read_mesh(write("a.vtk", mixed_vtk_text()), {.other_cells = OtherCells::Refuse}));
    };
    EXPECT_THAT(error_of(read_it), HasSubstr("a.vtk: the mesh has 2 hexahedra and 1 prism"));
    static_cast<void>(read_mesh(write("b.vtk", vtk_text(kBox)), {.other_cells = OtherCells::Refuse}));
}

TEST_F(VtkIo, OtherCellsAreSplitWithTheirValues) {
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

TEST_F(VtkIo, CellArraysBecomeVolumeWeightedMeans) {
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

TEST_F(VtkIo, CellArraysOfFoldedCellsStayInTheirRange) {
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

TEST_F(VtkIo, CellsMayHaveMorePointsThanTheirTypesCorners) {
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

TEST_F(VtkIo, CellsWithoutVolumeCountTheSame) {
    HexMesh flat = make_box(2, 1, 1);
    for (Vec3& x : flat.points) x.z = 0;
    const auto result = read("a.vtk", vtk_text(flat) + "CELL_DATA 2\nSCALARS s float\nLOOKUP_TABLE default\n10 20\n");
    EXPECT_EQ(result.mesh.find_attribute("s")->values[1], 15);
}

TEST_F(VtkIo, ArraysOfOneNameAreToldApart) {
    const auto result = read("a.vtk", vtk_text(make_box(1, 1, 1)) +
                                          "POINT_DATA 8\nSCALARS s int\nLOOKUP_TABLE default\n1 1 1 1 1 1 1 1\n"
                                          "CELL_DATA 1\nSCALARS s int\nLOOKUP_TABLE default\n2\n");
    EXPECT_EQ(result.mesh.find_attribute("s")->values[0], 1);
    EXPECT_EQ(result.mesh.find_attribute("s_2")->values[0], 2);
}

TEST_F(VtkIo, NonFiniteValuesCountOnlyAtUsedPoints) {
    HexMesh mesh = make_box(1, 1, 1);
    mesh.points.emplace_back(9, 9, 9);
    const std::string text = vtk_text(mesh) + "POINT_DATA 9\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8 nan\n";
    const auto result = read("a.vtk", text);
    EXPECT_EQ(result.fields[0].max, 8);
    const ReadResult gap = read("a.vtk", replaced(text, "8 nan", "1e999 0"));
    EXPECT_EQ(gap.mesh.attributes.size(), 0U);
    EXPECT_THAT(gap.warnings, Contains(HasSubstr("field \"s\" has no value at 1 of 8 points, and no cell has it at all")));
    EXPECT_EQ(gap.fields.at(0).missing, 1U);
    EXPECT_EQ(gap.fields.at(0).max, 7);
    const ReadResult none = read("a.vtk", vtk_text(mesh) + "CELL_DATA 1\nSCALARS s float\nLOOKUP_TABLE default\n-inf\n");
    EXPECT_EQ(none.unread.at(0).why, "the value at cell 0 is not finite");
}

// The counts of sections that are not those of the mesh, with as many values as they say, or as the mesh needs.
TEST_F(VtkIo, ArraysForAnotherNumberOfCellsAreLeftOut) {
    const auto numbers = [](int count) {
        std::string text;
        for (int i = 0; i < count; ++i) text += std::to_string(i) + "\n";
        return text;
    };
    const std::string head = vtk_text(make_box(2, 1, 1)), scalars = " int\nLOOKUP_TABLE default\n";
    const std::string points = "POINT_DATA 12\nSCALARS good" + scalars + numbers(12);
    const std::string wrong = "CELL_DATA 3\nSCALARS bad" + scalars + numbers(3) + "VECTORS worse float\n" + numbers(9);
    for (const std::string& text : {wrong + points, points + wrong}) {
        const ReadResult result = read("a.vtk", head + text);
        ASSERT_EQ(result.mesh.attributes.size(), 1U);
        EXPECT_EQ(result.mesh.attributes[0].name, "good");
        EXPECT_EQ(result.mesh.attributes[0].values[11], 11);
        EXPECT_THAT(result.warnings, Contains(testing::ContainsRegex(
                                         "2 fields left out \\(\"bad\", \"worse\"\\): .*a.vtk, line [0-9]+: CELL_DATA is for "
                                         "3 cells, but there are 2")));
        ASSERT_EQ(result.unread.size(), 2U);
    }
    for (const auto& [count, values] : {std::pair{3, 2}, {1, 2}, {0, 2}, {40, 2}, {13, 0}}) {
        const ReadResult result =
            read("a.vtk", head + points + "CELL_DATA " + std::to_string(count) + "\nSCALARS bad" + scalars + numbers(values));
        EXPECT_EQ(result.mesh.attributes.size(), 1U) << count;
        EXPECT_FALSE(result.warnings.empty()) << count;
    }
    EXPECT_THAT(read_error("a.vtk", head + "POINT_DATA 11\nSCALARS bad" + scalars + numbers(11)),
                HasSubstr("POINT_DATA is for 11 points, but there are 12"));
    const ReadResult tuples = read("a.vtk", head + "CELL_DATA 2\nFIELD f 2\nshort 1 1 int\n4\nc 1 2 int\n5 7\n");
    EXPECT_EQ(tuples.mesh.attributes.at(0).name, "c");
    EXPECT_THAT(tuples.unread.at(0).why, HasSubstr("FIELD array \"short\" has 1 tuples (2 are needed)"));
}

TEST_F(VtkIo, OneFieldThatIsNotFiniteStopsNoOther) {
    const std::string fields =
        "POINT_DATA 8\nSCALARS bad float\nLOOKUP_TABLE default\n1 2 3 4 nan 6 7 8\n"
        "SCALARS good float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8\n"
        "CELL_DATA 1\nSCALARS worse float\nLOOKUP_TABLE default\ninf\n";
    const ReadResult result = read("a.vtk", vtk_text(make_box(1, 1, 1)) + fields);
    ASSERT_EQ(result.fields.size(), 2u);
    EXPECT_EQ(result.fields[1].name, "good");
    EXPECT_EQ(result.mesh.attributes.size(), 1U);
    ASSERT_EQ(result.unread.size(), 1u);
    EXPECT_EQ(result.unread[0].name, "worse");
    EXPECT_THAT(result.warnings,
                testing::ElementsAre("field \"worse\" left out: the value at cell 0 is not finite",
                                     "field \"bad\" has no value at 1 of 8 points, and no cell has it at all of its points"));
}

// A cube and, on its right, a polyhedron: a cube whose left face is that one and whose right face is two triangles.
const std::vector<Vec3> kTwoBoxes{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1},
                                  {1, 1, 1}, {0, 1, 1}, {2, 0, 0}, {2, 1, 0}, {2, 0, 1}, {2, 1, 1}};
constexpr const char* kFaces = "7 4 1 2 6 5 4 1 8 9 2 4 5 6 11 10 4 1 5 10 8 4 2 9 11 6 3 8 10 9 3 9 10 11";

// Convex point sets are what their hulls are: points in any order; sets that are not convex are left out.
TEST_F(VtkIo, ConvexPointSetsAreTheirHulls) {
    const auto file = [](const std::string& points, std::size_t count, const std::string& cells, std::size_t cell_count,
                         std::size_t numbers) {
        std::string types;
        for (std::size_t c = 0; c < cell_count; ++c) types += "41\n";
        return "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " + std::to_string(count) +
               " double\n" + points + "\nCELLS " + std::to_string(cell_count) + " " + std::to_string(numbers) + "\n" + cells +
               "\nCELL_TYPES " + std::to_string(cell_count) + "\n" + types;
    };
    std::string boxes;
    for (const Vec3& x : kTwoBoxes) boxes += number(x.x) + " " + number(x.y) + " " + number(x.z) + "\n";
    const ReadResult two = read("two.vtk", file(boxes, 12, "8 6 1 0 3 7 2 5 4\n8 1 8 2 9 11 10 6 5", 2, 18));
    EXPECT_EQ(two.mesh.cells.size(), 2u);
    EXPECT_NEAR(inspect(two.mesh).volume, 2, 1e-12);
    EXPECT_EQ(inspect(two.mesh).inverted_cells, 0u);
    // An octahedron has the volume of its eight triangles.
    const std::string octahedron = "1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1 0 0 0";
    EXPECT_NEAR(inspect(read("o.vtk", file(octahedron, 7, "6 0 1 2 3 4 5", 1, 7)).mesh).volume, 4.0 / 3, 1e-12);
    // A point in the middle, points in one plane, and too few points.
    for (const char* cell : {"7 0 1 2 3 4 5 6", "5 0 1 2 3 6", "3 0 1 4"}) {
        const std::string text = file(octahedron, 7, cell, 1, static_cast<std::size_t>(cell[0] - '0') + 1);
        EXPECT_THAT(error_of([&] { static_cast<void>(read("bad.vtk", text)); }),
                    HasSubstr("no hexahedra, but 1 convex point set (VTK type 41), which are ignored"))
            << cell;
    }
}

TEST_F(VtkIo, PolyhedraAreSplitFromTheirMiddle) {
    std::string points, numbers;
    for (const Vec3& x : kTwoBoxes) {
        points += number(x.x) + " " + number(x.y) + " " + number(x.z) + "\n";
        numbers += number(x.x) + " ";
    }
    const std::string text = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n" + points +
                             "CELLS 2 44\n8 0 1 2 3 4 5 6 7\n34 " + kFaces +
                             "\nCELL_TYPES 2\n12 42\nPOINT_DATA 12\n"
                             "SCALARS s double\nLOOKUP_TABLE default\n" +
                             numbers +
                             "\nCELL_DATA 2\nSCALARS c double\n"
                             "LOOKUP_TABLE default\n3 4\n";
    const auto xml = [&](const std::string& faces) {
        return "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"><UnstructuredGrid><Piece NumberOfPoints=\"12\" "
               "NumberOfCells=\"2\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" +
               points +
               "</DataArray></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3 4 5 6 7 "
               "1 2 5 6 8 9 10 11</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">8 16</DataArray>"
               "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">12 42</DataArray>" +
               faces +
               "</Cells><PointData>"
               "<DataArray type=\"Float64\" Name=\"s\" format=\"ascii\">" +
               numbers +
               "</DataArray></PointData></Piece>"
               "</UnstructuredGrid></VTKFile>";
    };
    const auto array = [](const std::string& name, const std::string& values) {
        return "<DataArray type=\"Int64\" Name=\"" + name + "\" format=\"ascii\">" + values + "</DataArray>";
    };
    const std::string newer = array("face_connectivity", "1 2 6 5 1 8 9 2 5 6 11 10 1 5 10 8 2 9 11 6 8 10 9 9 10 11") +
                              array("face_offsets", "4 8 12 16 20 23 26") + array("polyhedron_to_faces", "0 1 2 3 4 5 6") +
                              array("polyhedron_offsets", "0 7");
    for (const auto& [name, contents] : std::vector<std::pair<std::string, std::string>>{
             {"a.vtk", text}, {"a.vtu", xml(array("faces", kFaces) + array("faceoffsets", "-1 34"))}, {"b.vtu", xml(newer)}}) {
        const ReadResult result = read(name, contents);
        EXPECT_NEAR(inspect(result.mesh).volume, 2, 1e-12) << name;
        EXPECT_EQ(inspect(result.mesh).inverted_cells, 0u) << name;
        EXPECT_EQ(inspect(result.mesh).nonmanifold_faces, 0u) << name;
        EXPECT_THAT(result.warnings, Contains("1 polyhedron split from the middle into 12 tetrahedra")) << name;
        // A linear field stays linear, also at the new points.
        const Attribute& s = *result.mesh.find_attribute("s");
        for (std::size_t p = 0; p < result.mesh.points.size(); ++p) EXPECT_NEAR(s.values[p], result.mesh.points[p].x, 1e-12);
        EXPECT_EQ(read(name, contents, {.other_cells = OtherCells::Ignore}).mesh.cells.size(), 1u);
    }
    EXPECT_THAT(read_error("a.vtk", replaced(text, "3 9 10 11", "3 9 10 12")), HasSubstr("cell 1: these are not the faces"));
    EXPECT_THAT(read("a.vtk", replaced(text, "3 9 10 11", "3 9 10 10")).warnings,
                Contains("1 polyhedron whose faces do not enclose a volume left out"));
    EXPECT_THAT(read_error("a.vtu", xml(array("faces", kFaces) + array("faceoffsets", "-1 99"))),
                HasSubstr("cell 1: its faces are not those of a polyhedron"));
}

// Prisms of five and six sides; one of six that repeats a corner in both bases has five.
TEST_F(VtkIo, PrismsOfFiveAndSixSidesAreSplit) {
    const auto prism = [](int sides, bool collapsed) {
        std::string points, corners;
        for (int k = 0; k < 2 * sides; ++k) {
            const double angle = 2 * 3.14159265358979323846 * (k % sides) / sides;
            points += std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + (k < sides ? " 0\n" : " 1\n");
        }
        for (int half = 0; half < 2; ++half) {
            for (int k = 0; k < sides; ++k) corners += " " + std::to_string(half * sides + k);
            if (collapsed) corners += " " + std::to_string(half * sides + sides - 1);
        }
        const int used = sides + collapsed;
        return "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " + std::to_string(2 * sides) +
               " double\n" + points + "CELLS 1 " + std::to_string(2 * used + 1) + "\n" + std::to_string(2 * used) + corners +
               "\nCELL_TYPES 1\n" + (used == 5 ? "15" : "16") + "\n";
    };
    const double five = 2.5 * std::sin(2 * 3.14159265358979323846 / 5), six = 1.5 * std::sqrt(3.0);
    EXPECT_NEAR(inspect(read("a.vtk", prism(5, false)).mesh).volume, five, 1e-5);  // six digits in the text
    EXPECT_NEAR(inspect(read("a.vtk", prism(6, false)).mesh).volume, six, 1e-5);
    const ReadResult collapsed = read("a.vtk", prism(5, true));
    EXPECT_NEAR(inspect(collapsed.mesh).volume, five, 1e-5);
    EXPECT_EQ(inspect(collapsed.mesh).inverted_cells, 0u);
    const auto ignored = [&] { std::ignore = read("a.vtk", prism(5, false), {.other_cells = OtherCells::Ignore}); };
    EXPECT_THAT(error_of(ignored), HasSubstr("1 pentagonal prism"));
}

TEST_F(VtkIo, CellsWithPointsOfTheirOwnAreSaid) {
    const HexMesh box = make_box(2, 2, 2);
    HexMesh apart;
    for (const auto& cell : box.cells) {
        auto& own = apart.cells.emplace_back();
        for (std::size_t k = 0; k < 8; ++k) {
            own[k] = static_cast<Index>(apart.points.size());
            apart.points.push_back(box.points[cell[k]]);
        }
    }
    EXPECT_THAT(
        read("a.vtk", vtk_text(apart)).warnings,
        ElementsAre(
            "8 groups of cells share no points, though 37 of 64 points lie at the places of others: --weld joins these"));
    EXPECT_EQ(inspect(read("a.vtk", vtk_text(apart), {.weld = 0}).mesh).points_used, 27u);
    EXPECT_THAT(read("a.vtk", vtk_text(box)).warnings, ElementsAre());
}

TEST_F(VtkIo, OlderGhostLevelsLeaveCellsOut) {
    const std::string text = vtk_text(make_box(3, 1, 1)) +
                             "CELL_DATA 3\nSCALARS vtkGhostLevels unsigned_char\n"
                             "LOOKUP_TABLE default\n0 0 2\n";
    const ReadResult result = read("a.vtk", text);
    EXPECT_EQ(result.mesh.cells.size(), 2u);
    EXPECT_TRUE(result.fields.empty());
}

TEST_F(VtkIo, FirstBytesDecideWhereTheExtensionIsUnknown) {
    const std::string text = vtk_text(make_box(1, 1, 1));
    EXPECT_EQ(read("a.dump", text).mesh.cells.size(), 1u);
    EXPECT_EQ(read("without", text).mesh.cells.size(), 1u);
    EXPECT_TRUE(is_mesh_file(path("a.dump")));
    EXPECT_THAT(read_error("a.dump", "nothing"), HasSubstr("\".dump\" files cannot be read"));
    EXPECT_THAT(read_error("a.med", "nothing"), HasSubstr("python3 -m subvol.convert a.med mesh.vtu converts it"));
    EXPECT_THAT(read_error("a.unv", "nothing"), HasSubstr("gmsh -save"));
    EXPECT_THAT(read_error("a.re2", "nothing"), HasSubstr("NAME.nek5000"));
    EXPECT_THAT(read_error("a.k", "nothing"), HasSubstr("meshio cannot read them either"));
    EXPECT_THAT(error_of([&] { write_mesh(path("a.dump"), make_box(1, 1, 1)); }), HasSubstr("files cannot be written"));
}

TEST_F(VtkIo, NamesInLatin1BecomeUtf8) {
    const auto result = read("a.vtk", vtk_text(make_box(1, 1, 1)) +
                                          "POINT_DATA 8\nSCALARS d\xE9"
                                          "bit int\nLOOKUP_TABLE default\n1 1 1 1 1 1 1 1\n");
    EXPECT_EQ(result.fields[0].name,
              "d\xC3\xA9"
              "bit");
}

}  // namespace vtk_io_test

}  // namespace subvol::test
