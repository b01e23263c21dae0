// SPDX-License-Identifier: Apache-2.0
// Legacy VTK whose values are big-endian numbers between lines of text.

#include <gmock/gmock.h>

#include <bit>

#include "binary_texts.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "mesh_texts.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

namespace vtk_binary_test {

using testing::ElementsAre;
using testing::HasSubstr;

class VtkBinary : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& text) const { return read_mesh(write("a.vtk", text)); }
    [[nodiscard]] std::string read_error(const std::string& text) const {
        return error_of([&] { static_cast<void>(read(text)); });
    }
};

const HexMesh kBox = make_box(2, 2, 2);

template <class T>
std::string big(const std::vector<T>& values) {
    return bytes_of<T>(values, std::endian::big);
}

TEST_F(VtkBinary, CountedCells) {
    const ReadResult result = read(binary_vtk_text(kBox));
    EXPECT_EQ(result.mesh.points, kBox.points);
    EXPECT_EQ(result.mesh.cells, kBox.cells);
    EXPECT_TRUE(result.warnings.empty());
}

TEST_F(VtkBinary, OffsetsAndConnectivity) {
    std::string text = "# vtk DataFile Version 5.1\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 27 float\n" +
                       big(coordinates_as<float>(kBox)) + "\nMETADATA\nINFORMATION 0\n\nCELLS 9 64\nOFFSETS vtktypeint64\n" +
                       big(std::vector<std::int64_t>{0, 8, 16, 24, 32, 40, 48, 56, 64}) + "\nCONNECTIVITY vtktypeint64\n" +
                       big(corners_as<std::int64_t>(kBox)) + "\nCELL_TYPES 8\n" + big(std::vector<std::int32_t>(8, 12)) + "\n";
    EXPECT_EQ(read(text).mesh.cells, kBox.cells);
    EXPECT_EQ(read(text).mesh.points, kBox.points);
    EXPECT_THAT(read_error(replaced(text, "OFFSETS vtktypeint64", "OFFSETS double")), HasSubstr("an integer type is needed"));
}

// One array of each type, with values that depend on the sign, the width and the byte order.
template <class T>
void expect_type(const std::string& type, const std::vector<T>& values, const ReadResult& result) {
    const Attribute* found = result.mesh.find_attribute(type);
    ASSERT_NE(found, nullptr) << type;
    EXPECT_EQ(found->values, std::vector<double>(values.begin(), values.end())) << type;
}

TEST_F(VtkBinary, EveryType) {
    const std::vector<std::int8_t> i8{0, 1, -1, 127, -128, 10, 13, 32};  // line ends and spaces among them
    const std::vector<std::uint8_t> u8{0, 1, 255, 127, 128, 10, 13, 32};
    const std::vector<std::int16_t> i16{0, 258, -2, 32767, -32768, 10, 13, 32};
    const std::vector<std::uint16_t> u16{0, 258, 65535, 32767, 32768, 10, 13, 32};
    const std::vector<std::int32_t> i32{0, 16909060, -2, 2147483647, -2147483647 - 1, 10, 13, 32};
    const std::vector<std::uint32_t> u32{0, 16909060, 4294967295u, 1, 2, 10, 13, 32};
    const std::vector<std::int64_t> i64{0, 72623859790382856, -2, 1, 2, 10, 13, 32};
    const std::vector<std::uint64_t> u64{0, 72623859790382856, 1ull << 63, 1, 2, 10, 13, 32};
    const std::vector<float> f32{0, -1.5f, 1e30f, 1, 2, 10, 13, 32};
    const std::vector<double> f64{0, -1.5, 1e300, 1, 2, 10, 13, 32};
    std::string text = binary_vtk_text(make_box(1, 1, 1)) + "POINT_DATA 8\nFIELD f 15\n";
    const auto add = [&](const std::string& type, const auto& values) {
        text += type + " 1 8 " + type + "\n" + big(values) + "\n";
    };
    add("char", i8);
    add("signed_char", i8);
    add("unsigned_char", u8);
    add("short", i16);
    add("unsigned_short", u16);
    add("int", i32);
    add("vtkIdType", i32);
    add("unsigned_int", u32);
    add("long", i64);
    add("vtktypeint64", i64);
    add("unsigned_long", u64);
    add("vtktypeuint64", u64);
    add("float", f32);
    add("double", f64);
    text += std::string("bit 1 8 bit\n\xA1\n");
    const ReadResult result = read(text);
    EXPECT_EQ(result.fields.size(), 15u);
    expect_type("char", i8, result);
    expect_type("signed_char", i8, result);
    expect_type("unsigned_char", u8, result);
    expect_type("short", i16, result);
    expect_type("unsigned_short", u16, result);
    expect_type("int", i32, result);
    expect_type("vtkIdType", i32, result);
    expect_type("unsigned_int", u32, result);
    expect_type("long", i64, result);
    expect_type("vtktypeint64", i64, result);
    expect_type("unsigned_long", u64, result);
    expect_type("vtktypeuint64", u64, result);
    expect_type("float", f32, result);
    expect_type("double", f64, result);
    expect_type("bit", std::vector<int>{1, 0, 1, 0, 0, 0, 0, 1}, result);
}

TEST_F(VtkBinary, EveryKindOfSection) {
    const std::vector<float> eight{0, 1, 2, 3, 4, 5, 6, 7};
    // Each text follows its length, which takes 1 or 2 bytes.
    const std::string texts = std::string("\xC3") + "a\nb" + std::string("\x80\x02") + "\n\n";
    std::string text = replaced(
        binary_vtk_text(make_box(1, 1, 1)), "POINTS",
        "FIELD FieldData 2\nt 1 2 float\n" + big(std::vector<float>{1, 2}) + "\nnames 1 2 string\n" + texts + "\nPOINTS");
    text += "CELL_DATA 1\nSCALARS c int 1\nLOOKUP_TABLE default\n" + big(std::vector<std::int32_t>{7}) + "\nPOINT_DATA 8\n" +
            "SCALARS s float\nLOOKUP_TABLE mine\n" + big(eight) + "\nLOOKUP_TABLE mine 1\n\n\n\n\n" + "\nVECTORS v double\n" +
            big(std::vector<double>(24, 0.5)) + "\nCOLOR_SCALARS rgb 3\n" + std::string(24, '\xFF') +
            "\nMETADATA\nINFORMATION 0\n\nTEXTURE_COORDINATES t 2 float\n" + big(std::vector<float>(16, 0.25f)) + "\n";
    const ReadResult result = read(text);
    EXPECT_EQ(result.mesh.find_attribute("c")->values, std::vector<double>(8, 7));
    EXPECT_EQ(result.mesh.find_attribute("s")->values, std::vector<double>(eight.begin(), eight.end()));
    EXPECT_EQ(result.mesh.find_attribute("v")->values, std::vector<double>(24, 0.5));
    EXPECT_EQ(result.mesh.find_attribute("rgb")->values, std::vector<double>(24, 1));
    EXPECT_EQ(result.mesh.find_attribute("t")->values, std::vector<double>(16, 0.25));
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("\"names\" ignored"), HasSubstr("cell array \"c\"")));
}

TEST_F(VtkBinary, HexahedraWithPointsOnTheirEdgesGiveTheirCorners) {
    HexMesh mesh = make_box(1, 1, 1);
    const std::vector<std::int32_t> cell{20, 0, 1, 3, 2, 4, 5, 7, 6, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8};
    mesh.points.emplace_back(9, 9, 9);
    const std::string text = "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 9 double\n" +
                             big(coordinates_as<double>(mesh)) + "\nCELLS 1 21\n" + big(cell) + "\nCELL_TYPES 1\n" +
                             big(std::vector<std::int32_t>{12}) + "\n";
    const ReadResult result = read_mesh(write("a.vtk", text), {.curved_tolerance = std::nullopt});
    EXPECT_EQ(result.mesh.cells, mesh.cells);
    EXPECT_THAT(result.warnings, ElementsAre("1 cell has more points than corners: only the corners are used"));
}

TEST_F(VtkBinary, ErrorsNameTheByte) {
    const std::string good = binary_vtk_text(kBox) + "POINT_DATA 27\nSCALARS s double 1\nLOOKUP_TABLE default\n" +
                             big(std::vector<double>(27, 1)) + "\n";
    static_cast<void>(read(good));
    EXPECT_THAT(read_error(good.substr(0, good.size() - 9)), HasSubstr("array \"s\": value 26: unexpected end of file"));
    EXPECT_THAT(read_error(good.substr(0, 100)), HasSubstr("a.vtk, byte"));
    EXPECT_THAT(read_error(replaced(good, "POINTS 27", "POINTS 4000000000")),
                HasSubstr("POINTS: count out of range: 4000000000"));
    EXPECT_THAT(read_error(replaced(good, "CELLS 8 72", "CELLS 8 71")), HasSubstr("cell 7 does not fit into the 71 numbers"));
    const std::size_t cells = good.find("CELLS 8 72\n") + 11;
    EXPECT_THAT(read_error(std::string(good).replace(cells + 8, 4, big(std::vector<std::int32_t>{27}))),
                HasSubstr("byte " + std::to_string(cells + 4) + ": cell 0: there is no point with index 27"));  // the cell's
}

}  // namespace vtk_binary_test

}  // namespace subvol::test
