// SPDX-License-Identifier: Apache-2.0
// What read_mesh does with whatever a reader has read.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "formats.h"
#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "mesh_texts.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

namespace check_read_test {

class CheckRead : public TempFolder {
protected:
    CheckRead() {
        read_.mesh = make_box(2, 1, 1);
        read_.mesh.attributes = {{"T", 1, std::vector<double>(12, 5)}};
    }
    [[nodiscard]] std::string wrong() const {
        ReadResult read = read_;
        return error_of([&] { detail::check_read(read, "a.vtu"); });
    }
    ReadResult read_;
};

TEST_F(CheckRead, NamesArePrintable) {
    const std::string name = "a\x1b[2J\n\u202eb", shown = "a\\x1b[2J\\x0a\\xe2\\x80\\xaeb";
    read_.mesh.attributes[0].name = name;
    read_.fields = {{name, "point", 1}};
    read_.fields[0].unit = name;
    read_.blocks = {{name, 2}};
    read_.unread = {{name, name}};
    read_.warnings = {name};
    read_.sets = {{{name, {{0, 0}}}}, {{name, {1}}}};
    detail::check_read(read_, "a.vtu");
    for (const std::string& found :
         {read_.mesh.attributes[0].name, read_.fields[0].name, read_.fields[0].unit, read_.blocks[0].name, read_.unread[0].name,
          read_.unread[0].why, read_.warnings[0], read_.sets.patches[0].name, read_.sets.sets[0].name}) {
        EXPECT_EQ(found, shown);
    }
}

TEST_F(CheckRead, NamesAreMadeDistinct) {
    const Attribute field = read_.mesh.attributes[0];
    read_.mesh.attributes = {field, field, field};
    read_.sets = {{{"p", {{0, 0}}}, {"p", {{1, 1}}}}, {{"s", {0}}, {"s", {1}}, {"", {1}}}};
    detail::check_read(read_, "a.vtu");
    EXPECT_EQ(read_.mesh.attributes[2].name, "T_3");
    EXPECT_EQ(read_.sets.patches[1].name, "p_2");
    EXPECT_EQ(read_.sets.sets[1].name, "s_2");
    EXPECT_EQ(read_.sets.sets[2].name, "unnamed");
    EXPECT_EQ(read_.warnings,
              (std::vector<std::string>{"there is more than one array \"T\": 2 others are called \"T_2\" to \"T_3\"",
                                        "there is more than one patch \"p\": another is called \"p_2\"",
                                        "there is more than one set of cells \"s\": another is called \"s_2\""}));
}

TEST_F(CheckRead, WhatIsThereTwiceOrNotAtAll) {
    read_.sets = {{{"p", {{0, 3}, {1, 2}, {0, 3}}}}, {}};
    EXPECT_EQ(wrong(), "a.vtu: patch \"p\" has side 3 of cell 0 more than once (once)");
    read_.sets = {{}, {{"s", {1, 0, 1}}}};
    EXPECT_EQ(wrong(), "a.vtu: set \"s\" has cell 1 more than once (once)");
    read_.sets = {{{"p", {{2, 0}}}}, {}};
    EXPECT_EQ(wrong(), "a.vtu: patch \"p\" has a side of cell 2 (less than 2)");
    read_.sets = {{{"p", {{1, 6}}}}, {}};
    EXPECT_EQ(wrong(), "a.vtu: patch \"p\" has side 6 (less than 6)");
}

TEST_F(CheckRead, MeshesThatAreNone) {
    read_.mesh.points[3].x = std::numeric_limits<double>::infinity();
    EXPECT_EQ(wrong(), "a.vtu: point 3: a coordinate is not finite");
    read_.mesh.points[3].x = 0;
    read_.mesh.attributes[0].values.pop_back();
    EXPECT_NE(wrong().find("attribute \"T\": has 11 values"), std::string::npos) << wrong();
    read_.mesh.cells.clear();
    EXPECT_NE(wrong().find("no hexahedra"), std::string::npos) << wrong();
}

TEST_F(CheckRead, Bounds) {
    Attribute& field = read_.mesh.attributes[0];
    for (std::size_t p = 0; p < 12; ++p) field.values[p] = static_cast<double>(p);
    const auto with = [&](const std::vector<std::array<double, 2>>& bounds) {
        read_.mesh.attributes[0].bounds = bounds;
        return wrong();
    };
    constexpr double kInf = std::numeric_limits<double>::infinity();
    EXPECT_EQ(with({{0, 11}}), "no error");
    EXPECT_EQ(with({{-kInf, kInf}}), "no error");
    EXPECT_NE(with({{0, 1}, {0, 1}}).find("has 2 pairs of bounds"), std::string::npos);
    EXPECT_NE(with({{4, 3}}).find("has the bounds 4 to 3 (the lower one first)"), std::string::npos);
    EXPECT_NE(with({{std::nan(""), 3}}).find("the lower one first"), std::string::npos);
    EXPECT_NE(with({{12, 13}}).find("no value lies within them (its values are 0 to 11)"), std::string::npos)
        << with({{12, 13}});
    EXPECT_NE(with({{-2, -.5}}).find("no value lies within them"), std::string::npos);
    // 8 to 11 are cut off; what is a hundredth of the range beyond is rounding.
    read_.mesh.attributes[0].bounds = {{0, 7}};
    detail::check_read(read_, "a.vtu");
    EXPECT_EQ(read_.warnings, std::vector<std::string>{"4 values of \"T\" lie outside of the bounds that the file gives it, "
                                                       "where the limit is cut off"});
    read_.warnings.clear();
    read_.mesh.attributes[0].bounds = {{0, 10.95}};
    detail::check_read(read_, "a.vtu");
    EXPECT_TRUE(read_.warnings.empty());
}

/// A reader that assembles its mesh, and one that does not.
TEST_F(CheckRead, FilesPassThroughIt) {
    HexMesh mesh = make_box(1, 1, 1);
    std::string text = gmsh_text(mesh, "2 1 3");
    const std::string names = "$PhysicalNames\n1\n3 1 \"a\x1b[2Jb\"\n$EndPhysicalNames\n";
    text.insert(text.find("$Nodes"), names);
    const ReadResult read = read_mesh(write("a.msh", text));
    for (const CellSet& set : read.sets.sets) EXPECT_EQ(set.name.find('\x1b'), std::string::npos);
    ASSERT_EQ(read.sets.sets.size(), 1u);
    EXPECT_EQ(read.sets.sets[0].name, "a\\x1b[2Jb");
}

}  // namespace check_read_test

}  // namespace subvol::test
