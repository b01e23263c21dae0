// SPDX-License-Identifier: Apache-2.0
#include "subvol/read_labels.h"

#include <gmock/gmock.h>

#include "lib/temp_folder.h"
#include "subvol/control_mesh.h"

namespace subvol {
namespace read_labels_test {

using test::error_of;
using testing::HasSubstr;

/// 12 labels of 2 x 3 x 2 voxels, the first axis fastest.
constexpr const char* kLabels = "1 2 0 2 1 1  0 0 0 3 3 1";

class ReadLabels : public test::TempFolder {
protected:
    LabelGrid read(const std::string& name, const std::string& text, const std::optional<std::string>& array = {}) const {
        return read_labels(write(name, text), array);
    }

    static std::string nrrd(const std::string& fields, const std::string& data) {
        return "NRRD0005\ndimension: 3\nsizes: 2 3 2\n" + fields + "\n" + data;
    }

    static std::string image(const std::string& attributes, const std::string& arrays) {
        return "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\"><ImageData " + attributes +
               "><Piece Extent=\"4 6 0 3 0 2\"><CellData>" + arrays + "</CellData></Piece></ImageData></VTKFile>";
    }
    static std::string array(const std::string& name, const std::string& type = "Int32") {
        return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"ascii\">" + kLabels + "</DataArray>";
    }

    /// Expects the labels above.
    static void expect_labels(const LabelGrid& grid) {
        ASSERT_EQ(grid.blocks().size(), 1U);
        const LabelGrid::Block& block = grid.blocks().begin()->second;
        const auto at = [&](std::size_t x, std::size_t y, std::size_t z) { return block.at(x + 8 * (y + 8 * z)); };
        EXPECT_EQ(at(0, 0, 0), 1);
        EXPECT_EQ(at(1, 1, 0), 2);
        EXPECT_EQ(at(0, 1, 0), 0);
        EXPECT_EQ(at(1, 1, 1), 3);
        EXPECT_EQ(at(1, 2, 1), 1);
        EXPECT_EQ(at(2, 0, 0), 0);
    }
};

TEST_F(ReadLabels, NrrdHasDirectionsAndAnOrigin) {
    const LabelGrid grid =
        read("a.nrrd", nrrd("# a remark\ntype: short\nencoding: ascii\nkey:=type: float\nspace dimension: 3\n"
                            "space directions: (0, 2,0) (0.5,0,0)  (0,0,-3)\nspace origin: (1,2,3.5)\n",
                            kLabels));
    expect_labels(grid);
    EXPECT_EQ(grid.to_world(), Mat3(Vec3(0, 2, 0), Vec3(0.5, 0, 0), Vec3(0, 0, -3)));
    EXPECT_EQ(grid.origin(), Vec3(1, 2, 3.5));
    const LabelGrid spaced =
        read("b.nrrd", nrrd("type: uint8\nencoding: raw\nspacings: 1 2 .5\n", std::string("\1\2\0\2\1\1\0\0\0\3\3\1", 12)));
    expect_labels(spaced);
    EXPECT_EQ(spaced.to_world(), Mat3(Vec3(1, 0, 0), Vec3(0, 2, 0), Vec3(0, 0, 0.5)));
    std::string big;
    for (const char* label = "\1\2\0\2\1\1\0\0\0\3\3\1"; big.size() < 24; ++label) big += {'\0', *label};
    expect_labels(read("c.nrrd", nrrd("type: ushort\r\nendian: big\r\nencoding: raw\r\n", big)));
}

TEST_F(ReadLabels, AnImageHasCellsOfItsExtent) {
    const LabelGrid grid =
        read("a.vti", image("Origin=\"10 0 -1\" Spacing=\"2 1 .5\" Direction=\"0 -1 0 1 0 0 0 0 1\"", array("tissue")));
    expect_labels(grid);
    // The middle of the first cell is at (4.5, .5, .5) in steps of the image, which is turned about z by a right angle.
    EXPECT_EQ(grid.origin(), Vec3(10 - 0.5, 9, -0.75));
    EXPECT_EQ(grid.to_world(), Mat3(Vec3(0, 2, 0), Vec3(-1, 0, 0), Vec3(0, 0, 0.5)));
    expect_labels(read("b.vti", image("", array("heat", "Float64") + array("tissue", "UInt8"))));
    expect_labels(read("c.vti", image("", array("one") + array("two")), "two"));
}

TEST_F(ReadLabels, WhatIsNotLabelsIsRefusedWithItsFile) {
    const auto error = [&](const std::string& name, const std::string& text, const std::optional<std::string>& chosen = {}) {
        const std::string words = error_of([&] { (void)read(name, text, chosen); });
        EXPECT_THAT(words, HasSubstr(name));
        return words;
    };
    EXPECT_THAT(error("a.vti", image("", array("heat", "Float64"))), HasSubstr("no array has integers"));
    EXPECT_THAT(error("a.vti", image("", array("one") + array("two"))), HasSubstr("several arrays"));
    EXPECT_THAT(error("a.vti", image("", array("one")), "two"), HasSubstr("\"two\" is not there"));
    EXPECT_THAT(error("a.vti", image("Spacing=\"1 1\"", array("one"))), HasSubstr("3 numbers"));
    EXPECT_THAT(error("a.nrrd", nrrd("type: double\nencoding: ascii\n", kLabels)), HasSubstr("integers, which are labels"));
    EXPECT_THAT(error("a.nrrd", nrrd("type: short\nencoding: raw\n", kLabels)), HasSubstr("no field \"endian\""));
    EXPECT_THAT(error("a.nrrd", nrrd("type: short\nencoding: ascii\n", "1 2 3")), HasSubstr("3 labels for 12 voxels"));
    EXPECT_THAT(error("a.nrrd", "NRRD0004\ntype: short"), HasSubstr("the header has no end"));
    EXPECT_THAT(error("a.nrrd", nrrd("type: uchar\nencoding: gzip\n", "not gzip")), HasSubstr("not whole"));
    EXPECT_THAT(error("a.txt", ""), HasSubstr(".vti or .nrrd"));
}

}  // namespace read_labels_test
}  // namespace subvol
