// SPDX-License-Identifier: Apache-2.0
// VTK XML in every encoding.

#include <gmock/gmock.h>

#include <limits>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"
#include "vtu_texts.h"

namespace subvol::test {

namespace vtu_io_test {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;

class VtuIo : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& text) const { return read_mesh(write("a.vtu", text)); }
    [[nodiscard]] std::string read_error(const std::string& text) const {
        return error_of([&] { static_cast<void>(read(text)); });
    }
};

HexMesh third_box() {
    HexMesh mesh = make_box(2, 2, 1);
    for (Vec3& x : mesh.points) x = x / 3.0;
    return mesh;
}

const HexMesh kBox = third_box();

std::vector<double> ramp(std::size_t count) {
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<double>(i) / 7;
    return values;
}

std::string with_arrays(VtuText& vtu) {
    std::string data = "<PointData>\n" + vtu.array("Float64", "Name=\"s\"", ramp(18));
    data += vtu.array("Float32", "Name=\"v &lt;m/s&gt;\" NumberOfComponents=\"3  \"", std::vector<float>(54, -0.5f));
    data += "</PointData>\n<CellData>\n" + vtu.array("Int16", "Name=\"c\"", std::vector<std::int16_t>{-3, -3, -3, -3});
    data += "</CellData>\n";
    const std::string times =
        "<FieldData>" + vtu.array("Float64", "Name=\"TimeValue\"", std::vector<double>{1}) + "</FieldData>\n";
    return vtu.file(times + vtu.piece(kBox, data));
}

TEST_F(VtuIo, EveryEncodingGivesTheSameBits) {
    std::vector<VtuText> encodings{{.format = "ascii"}};
    for (const std::string compressor : {"", "vtkZLibDataCompressor", "vtkLZMADataCompressor", "vtkLZ4DataCompressor"}) {
        for (const std::string header : {"UInt32", "UInt64"}) {
            for (const std::endian order : {std::endian::little, std::endian::big}) {
                encodings.push_back({"binary", "", compressor, header, order});
                encodings.push_back({"appended", "raw", compressor, header, order});
                encodings.push_back({"appended", "base64", compressor, header, order});
            }
        }
    }
    for (VtuText vtu : encodings) {
        SCOPED_TRACE(vtu.format + " " + vtu.encoding + " " + vtu.compressor + " " + vtu.header_type +
                     (vtu.order == std::endian::big ? " big" : " little"));
        const ReadResult result = read(with_arrays(vtu));
        EXPECT_EQ(result.mesh.points, kBox.points);
        EXPECT_EQ(result.mesh.cells, kBox.cells);
        ASSERT_EQ(result.fields.size(), 3u);
        EXPECT_EQ(result.mesh.find_attribute("s")->values, ramp(18));
        EXPECT_EQ(result.mesh.find_attribute("v <m/s>")->values, std::vector<double>(54, -0.5));
        EXPECT_EQ(result.mesh.find_attribute("c")->values, std::vector<double>(18, -3));
        EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("cell array \"c\"")));
    }
}

template <class T>
std::string array_of(VtuText& vtu, const std::string& type) {
    constexpr T kLow = std::numeric_limits<T>::lowest();
    constexpr T kHigh = std::numeric_limits<T>::max();
    return vtu.array(type, "Name=\"" + type + "\"", std::vector<T>{kLow, kHigh, 0, 1, 10, 13, 32, 60});
}

TEST_F(VtuIo, EveryType) {
    for (VtuText vtu : {VtuText{.format = "ascii"}, VtuText{.format = "appended"}}) {
        const std::string arrays = array_of<std::int8_t>(vtu, "Int8") + array_of<std::uint8_t>(vtu, "UInt8") +
                                   array_of<std::int16_t>(vtu, "Int16") + array_of<std::uint16_t>(vtu, "UInt16") +
                                   array_of<std::int32_t>(vtu, "Int32") + array_of<std::uint32_t>(vtu, "UInt32") +
                                   array_of<std::int64_t>(vtu, "Int64") + array_of<std::uint64_t>(vtu, "UInt64") +
                                   array_of<float>(vtu, "Float32") + array_of<double>(vtu, "Float64");
        const HexMesh mesh = read(vtu.file(vtu.piece(make_box(1, 1, 1), "<PointData>" + arrays + "</PointData>"))).mesh;
        const auto expect_ends = [&](const std::string& type, double low, double high) {
            const std::vector<double> expected{low, high, 0, 1, 10, 13, 32, 60};
            EXPECT_EQ(mesh.find_attribute(type)->values, expected) << type << " " << vtu.format;
        };
        expect_ends("Int8", -128, 127);
        expect_ends("UInt8", 0, 255);
        expect_ends("Int16", -32768, 32767);
        expect_ends("UInt16", 0, 65535);
        expect_ends("Int32", -2147483648.0, 2147483647);
        expect_ends("UInt32", 0, 4294967295.0);
        expect_ends("Int64", -9223372036854775808.0, 9223372036854775808.0);  // the nearest doubles
        expect_ends("UInt64", 0, 18446744073709551616.0);
        const double float_max = std::numeric_limits<float>::max();
        if (vtu.format == "appended") expect_ends("Float32", -float_max, float_max);
        expect_ends("Float64", std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
    }
}

// What another program would read is another number: 300 in a byte is 44.
TEST_F(VtuIo, WordsAreNumbersOfTheirType) {
    const auto text = [](const std::string& type, const std::string& word) {
        VtuText vtu{.format = "ascii"};
        const std::string values = vtu.array("Float64", "Name=\"f\"", std::vector<double>{0, 1, 2, 3, 4, 5, 6, 54321});
        return vtu.file(vtu.piece(make_box(1, 1, 1),
                                  "<PointData>" + replaced(replaced(values, "Float64", type), "54321", word) + "</PointData>"));
    };
    const std::vector<std::array<std::string, 3>> cases{
        {"Int8", "127", "128"},         {"Int8", "-128", "-129"},
        {"UInt8", "255", "300"},        {"UInt8", "0", "-1"},
        {"Int16", "32767", "40000"},    {"UInt16", "65535", "65536"},
        {"Int32", "7.0", "1.5"},        {"Int32", "2147483647", "3000000000"},
        {"UInt32", "4294967295", "-1"}, {"Int64", "9223372036854775807", "1e19"},
        {"UInt64", "1e19", "2e19"},     {"Float32", "3.4028235e38", "1e39"},
    };
    for (const auto& [type, good, bad] : cases) {
        EXPECT_EQ(read(text(type, good)).mesh.find_attribute("f")->values[7], std::stod(good)) << type;
        EXPECT_THAT(read_error(text(type, bad)),
                    HasSubstr("array \"f\": value 7: a number of the type " + type + " is expected, not \"" + bad + "\""));
    }
}

TEST_F(VtuIo, WhatIsWrittenIsReadAgainToTheBit) {
    HexMesh mesh = kBox;
    mesh.attributes = {{"a<\"b\">", 1, ramp(18)}, {"v", 3, ramp(54)}};
    write_mesh(path("a.vtu"), mesh);
    const ReadResult back = read_mesh(path("a.vtu"));
    EXPECT_EQ(back.mesh.points, mesh.points);
    EXPECT_EQ(back.mesh.cells, mesh.cells);
    ASSERT_EQ(back.mesh.attributes.size(), 2u);
    EXPECT_EQ(back.mesh.attributes[0].name, mesh.attributes[0].name);
    EXPECT_EQ(back.mesh.attributes[0].values, mesh.attributes[0].values);
    EXPECT_EQ(back.mesh.attributes[1].values, mesh.attributes[1].values);
    EXPECT_TRUE(back.warnings.empty());
}

// Blocks have 128 KiB; 32 of them are compressed at once.
TEST_F(VtuIo, ManyBlocksAreOneArray) {
    HexMesh mesh = make_box(42, 42, 42);
    mesh.attributes = {{"s", 1, ramp(mesh.points.size())}};
    write_mesh(path("a.vtu"), mesh);
    const ReadResult back = read_mesh(path("a.vtu"));
    EXPECT_EQ(back.mesh.points, mesh.points);
    EXPECT_EQ(back.mesh.cells, mesh.cells);
    EXPECT_EQ(back.mesh.attributes[0].values, mesh.attributes[0].values);
}

TEST_F(VtuIo, PiecesFollowEachOther) {
    VtuText vtu{.format = "appended"};
    const HexMesh first = make_box(2, 1, 1);
    HexMesh second = make_box(1, 1, 1);
    for (Vec3& x : second.points) x += Vec3(5, 0, 0);
    const std::string a = "<PointData>" + vtu.array("Float64", "Name=\"s\"", ramp(12)) + "</PointData><CellData>" +
                          vtu.array("Int32", "Name=\"c\"", std::vector<std::int32_t>{1, 1}) +
                          vtu.array("Int32", "Name=\"only here\"", std::vector<std::int32_t>{1, 1}) + "</CellData>";
    const std::string b = "<PointData>" + vtu.array("Float64", "Name=\"s\"", std::vector<double>(8, 9)) +
                          "</PointData><CellData>" + vtu.array("Int32", "Name=\"c\"", std::vector<std::int32_t>{2}) +
                          "</CellData>";
    const std::string empty =
        "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"><PointData><DataArray type=\"Float64\" "
        "Name=\"s\" format=\"ascii\"/></PointData></Piece>\n";
    const ReadResult result = read(vtu.file(empty + vtu.piece(first, a) + vtu.piece(second, b)));
    const MeshReport report = inspect(result.mesh);
    EXPECT_EQ(report.points_used, 20u);
    EXPECT_EQ(report.volume, 3);
    EXPECT_EQ(result.mesh.find_attribute("s")->values[13], 9);
    EXPECT_EQ(result.mesh.find_attribute("c")->values[0], 1);
    EXPECT_EQ(result.mesh.find_attribute("c")->values[19], 2);
    EXPECT_THAT(result.warnings,
                ElementsAre(HasSubstr("3 pieces put together"), HasSubstr("\"only here\" has no value at 1 of 3 cells"),
                            HasSubstr("cell array \"c\"")));
}

TEST_F(VtuIo, OtherCellsAreSplit) {
    VtuText vtu;
    const std::string data = "<CellData>" + vtu.array("Int32", "Name=\"c\"", std::vector<int>{4, 5, 6}) + "</CellData>";
    std::string text = vtu.file(vtu.piece(make_box(2, 1, 1), data));
    text = replaced(text, "NumberOfCells=\"2\"", "NumberOfCells=\"3\"");
    text = replaced(replaced(text, "11 10 \n", "11 10 0 1 3 9 \n"), "8 16 \n", "8 16 20 \n");
    const auto with_type = [&](const std::string& type) { return replaced(text, "12 12 \n", "12 12 " + type + "\n"); };
    const ReadResult quad = read(with_type("9"));  // no face of a hexahedron: a sheet
    EXPECT_EQ(quad.shells.quads.size(), 1u);
    EXPECT_THAT(quad.warnings, ElementsAre(HasSubstr("\"c\"")));
    const ReadResult split = read(with_type("10"));
    EXPECT_THAT(split.warnings[0], HasSubstr("2 hexahedra and 1 tetrahedron split into 20 hexahedra"));
    const auto& c = split.mesh.find_attribute("c")->values;
    // The last three points lie inside the cells, in the order of their sorted corners: 0 1 3 4 …, 0 1 3 9, 1 2 4 5 ….
    EXPECT_THAT(std::vector<double>(c.end() - 3, c.end()), ElementsAre(DoubleEq(4), DoubleEq(6), DoubleEq(5)));
}

TEST_F(VtuIo, TextArraysAreLeftOut) {
    VtuText vtu;
    const std::string data =
        "<PointData><Array type=\"String\" Name=\"names\" format=\"ascii\">65 0</Array>"
        "<DataArray type=\"Float64\" Name=\"s\" format=\"ascii\"><![CDATA[1 2 3 4 5 6 7 8]]>"
        "<InformationKey name=\"x\">1</InformationKey></DataArray></PointData>";
    const ReadResult result = read(vtu.file(vtu.piece(make_box(1, 1, 1), data)));
    EXPECT_THAT(result.warnings, ElementsAre("array \"names\" ignored: it is of type String"));
    EXPECT_EQ(result.mesh.find_attribute("s")->values[7], 8);
}

TEST_F(VtuIo, ErrorsNameFileLineAndArray) {
    VtuText vtu;
    const std::string good = with_arrays(vtu);
    static_cast<void>(read(good));
    const std::vector<std::array<std::string, 3>> cases{
        {"=\"UnstructuredGrid\"", "=\"PolyData\"", "line 1: \"PolyData\" is not an UnstructuredGrid"},
        {"</Piece>", "", "line 34: not well-formed XML"},
        {"LittleEndian", "MiddleEndian", "byte_order \"MiddleEndian\" is unknown"},
        {"UInt32", "UInt16", "header_type \"UInt16\" is unknown"},
        {"version=\"1.0\"", "compressor=\"zip\"", "compressor \"zip\" is not supported"},
        {"NumberOfPoints=\"18\"", "NumberOfPoints=\"x\"", "line 3: NumberOfPoints is missing or not a count"},
        {"NumberOfPoints=\"18\"", "NumberOfPoints=\"-1\"", "NumberOfPoints is missing or not a count"},
        {"NumberOfPoints=\"18\"", "NumberOfPoints=\"99999999999\"", "NumberOfPoints: count out of range"},
        {"NumberOfPoints=\"18\"", "NumberOfPoints=\"4000000000\"", "\"Points\": it has 54 values (12000000000 are needed"},
        {"NumberOfPoints=\"18\"", "NumberOfPoints=\"17\"", "\"Points\": it has 54 values (51 are needed"},
        {"NumberOfCells=\"4\"", "NumberOfCells=\"5\"", "\"offsets\": it has 4 values (5 are needed: one a cell)"},
        {"8 16 24", "8 25 24", "\"offsets\": offset 2 is 24"},
        {"8 16 24", "-8 16 24", "\"offsets\": offset 0 is -8"},
        {"8 16 24", "8 17 24", "cell 1 has 9 corners (a hexahedron has 8)"},
        {"12 12 12 12", "12 12 12", "\"types\": it has 3 values (4 are needed"},
        {"0 1 4 3", "0 1 18 3", "\"connectivity\": cell 0: there is no point with index 18"},
        {"0 1 4 3", "0 1 -1 3", "\"connectivity\": cell 0: there is no point with index -1"},
        {"0 1 4 3", "0 1 0 3", "cell 0 has point 0 twice"},
        {"0 1 4 3", "0 1.5 4 3", "array \"connectivity\": value 1: an integer is expected, not \"1.5\""},
        {"type=\"Int32\"", "type=\"Float32\"", "\"connectivity\": an integer type is needed"},
        {"type=\"Float64\" Name=\"s\"", "type=\"Real\" Name=\"s\"", "\"s\": the type \"Real\" is not supported"},
        {"NumberOfComponents=\"3  \"", "NumberOfComponents=\"0\"", "it cannot have \"0\" components"},
        {"NumberOfComponents=\"3  \"", "NumberOfComponents=\"-1\"", "it cannot have \"-1\" components"},
        {"NumberOfComponents=\"3  \"", "NumberOfComponents=\"1.5\"", "it cannot have \"1.5\" components"},
        {"NumberOfComponents=\"3  \"", "NumberOfComponents=\"\"", "it cannot have \"\" components"},
        {"Name=\"connectivity\"", "Name=\"corners\"", "the piece has no array connectivity"},
        {"format=\"ascii\"", "format=\"morse\"", "format \"morse\" is unknown"},
        {"0.33333333333333331 0 0", "inf 0 0", "non-finite coordinate at point 1"},
    };
    const std::size_t field_data = good.find("<FieldData>");
    const std::size_t piece = good.find("<Piece");
    const std::string plain = std::string(good).erase(field_data, piece - field_data);
    for (const auto& [from, to, message] : cases) {
        EXPECT_THAT(read_error(replaced(plain, from, to)), HasSubstr(message)) << from << " -> " << to;
    }
    EXPECT_THAT(read_error(""), HasSubstr("the file is empty"));
    EXPECT_THAT(read_error("\n<Other/>"), HasSubstr("a.vtu, line 2: not a VTK XML file: its root element is \"Other\""));
    EXPECT_THAT(read_error("<VTKFile type=\"UnstructuredGrid\"/>"), HasSubstr("there is no UnstructuredGrid element"));
}

TEST_F(VtuIo, DamagedDataAreRefused) {
    VtuText vtu{.format = "appended", .compressor = "vtkZLibDataCompressor", .header_type = "UInt64"};
    const std::string good = with_arrays(vtu);
    static_cast<void>(read(good));
    const std::size_t data = good.find("\n _") + 3;
    EXPECT_THAT(read_error(good.substr(0, data)), HasSubstr("there are no appended data"));
    EXPECT_THAT(read_error(good.substr(0, good.find("\n</AppendedData>") - 8)), HasSubstr("beyond the end of the data"));
    EXPECT_THAT(read_error(replaced(good, "vtkZLibDataCompressor", "vtkLZ4DataCompressor")), HasSubstr("decompression failed"));
    EXPECT_THAT(read_error(replaced(good, "vtkZLibDataCompressor", "vtkLZMADataCompressor")),
                HasSubstr("decompression failed"));

    // A size that no such block can have is refused before any allocation.
    VtuText plain{.format = "appended", .header_type = "UInt64"};
    std::string huge = with_arrays(plain);
    huge.replace(huge.find("\n _") + 3, 8, bytes_of(std::vector<std::uint64_t>{1ull << 60}, std::endian::little));
    EXPECT_THAT(read_error(huge), HasSubstr("its 1152921504606846976 bytes go beyond the end of the data"));
}

// As ParaView's Catalyst has written them: with the values of ghost cells that the grid does not have.
TEST_F(VtuIo, AFieldAtAnotherNumberOfCellsIsLeftOut) {
    VtuText vtu;
    const HexMesh mesh = make_box(2, 1, 1);
    const std::string cells = "<CellData>" + vtu.array("Float64", "Name=\"long\"", std::vector<double>{1, 2, 3}) +
                              vtu.array("Float64", "Name=\"right\"", std::vector<double>{5, 7}) + "</CellData>";
    const ReadResult result = read(vtu.file(vtu.piece(mesh, cells)));
    EXPECT_EQ(result.mesh.cells, mesh.cells);
    EXPECT_EQ(result.mesh.find_attribute("long"), nullptr);
    ASSERT_NE(result.mesh.find_attribute("right"), nullptr);
    EXPECT_EQ(result.mesh.find_attribute("right")->cells, (std::vector<double>{5, 7}));
    ASSERT_EQ(result.unread.size(), 1u);
    EXPECT_EQ(result.unread[0].name, "long");
    EXPECT_THAT(result.unread[0].why, HasSubstr("it has 3 values, 1 a cell for 2 cells are needed"));
    // Values at points are not sure to be where the points are.
    const std::string points =
        "<PointData>" + vtu.array("Float64", "Name=\"p\"", std::vector<double>{1, 2, 3}) + "</PointData>";
    EXPECT_THAT(read_error(vtu.file(vtu.piece(mesh, points))), HasSubstr("it has 3 values (12 are needed: 1 a point)"));
}

}  // namespace vtu_io_test

}  // namespace subvol::test
