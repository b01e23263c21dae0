// SPDX-License-Identifier: Apache-2.0
// XDMF, with values in the text and in binary files.

#include <gmock/gmock.h>

#include "lib/test_meshes.h"
#include "mesh_damage.h"
#include "mesh_texts.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace xdmf_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

template <class Values>
std::string item(const Values& values, const std::string& dimensions, const std::string& attributes = "") {
    std::string text = "<DataItem Dimensions=\"" + dimensions + "\" Format=\"XML\" " + attributes + ">";
    for (const auto value : values) text += number(static_cast<double>(value)) + " ";
    return text + "</DataItem>\n";
}

std::string geometry(const HexMesh& mesh, const Vec3& shift = Vec3(0)) {
    std::vector<double> values;
    for (const Vec3& x : mesh.points) values.insert(values.end(), {x.x + shift.x, x.y + shift.y, x.z + shift.z});
    return "<Geometry GeometryType=\"XYZ\">" + item(values, std::to_string(mesh.points.size()) + " 3") + "</Geometry>\n";
}

std::string topology(const HexMesh& mesh) {
    std::vector<Index> corners;
    for (const auto& cell : mesh.cells) corners.insert(corners.end(), cell.begin(), cell.end());
    const std::string count = std::to_string(mesh.cells.size());
    return "<Topology TopologyType=\"Hexahedron\" NumberOfElements=\"" + count + "\">" + item(corners, count + " 8") +
           "</Topology>\n";
}

std::string array(const std::string& name, const std::string& center, const std::vector<double>& values) {
    return "<Attribute Name=\"" + name + "\" Center=\"" + center + "\" AttributeType=\"Scalar\">" +
           item(values, std::to_string(values.size())) + "</Attribute>\n";
}

std::string grid(const std::string& content, const std::string& attributes = "Name=\"g\" GridType=\"Uniform\"") {
    return "<Grid " + attributes + ">\n" + content + "</Grid>\n";
}

std::string document(const std::string& content) {
    return "<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"3.0\" "
           "xmlns:xi=\"http://www.w3.org/2001/XInclude\"><Domain>\n" +
           content + "</Domain></Xdmf>\n";
}

const std::string kTemporal = "Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\"";

class Xdmf : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& content, const ReadOptions& options = {}) const {
        return read_mesh(write("a.xdmf", document(content)), options);
    }
    [[nodiscard]] std::string error(const std::string& content) const {
        return error_of([&] { static_cast<void>(read(content)); });
    }
};

TEST_F(Xdmf, CellsAndFieldsOfAGrid) {
    const HexMesh mesh = make_box(2, 1, 1);
    const ReadResult result =
        read(grid(topology(mesh) + geometry(mesh) + array("T", "Node", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}) +
                  array("c", "Cell", {3, 3}) + "<Attribute Name=\"U\" Center=\"Node\" AttributeType=\"Vector\">" +
                  item(std::vector<double>(36, 2), "12 3") + "</Attribute>"));
    EXPECT_EQ(result.mesh.points, mesh.points);
    EXPECT_EQ(result.mesh.cells, mesh.cells);
    EXPECT_EQ(result.mesh.find_attribute("T")->values[7], 7);
    EXPECT_EQ(result.mesh.find_attribute("c")->values[0], 3);
    EXPECT_EQ(result.mesh.find_attribute("U")->channels, 3);
}

// As every file of PyLith has them. External ones and those that grow without end are not expanded.
TEST_F(Xdmf, EntitiesThatTheFileDeclares) {
    const HexMesh mesh = make_box(1, 1, 1);
    const std::string cells = grid(topology(mesh) + geometry(mesh) + array("&field;", "Node", {0, 1, 2, 3, 4, 5, 6, 7}));
    const auto with = [&](const std::string& declarations) {
        std::string text = document(cells);
        text.insert(text.find("[]") + 1, "\n" + declarations);
        return read_mesh(write("a.xdmf", text));
    };
    const auto name = [&](const std::string& declarations) { return with(declarations).mesh.attributes.at(0).name; };
    EXPECT_EQ(name("<!ENTITY field \"T\">\n<!ENTITY other 'x'>\n"), "T");
    EXPECT_EQ(name("<!ENTITY quantity 'T'><!ENTITY field \"wall &quantity; of A&amp;B\">"), "wall T of A&B");
    const std::string secret = write("secret.txt", "secret");
    EXPECT_EQ(name("<!ENTITY field SYSTEM \"" + secret + "\">"), "&field;");
    std::string laughs = "<!ENTITY a0 \"hahahahahahahaha\">";
    for (int i = 1; i < 9; ++i) {
        std::string ten;
        for (int k = 0; k < 10; ++k) ten += "&a" + std::to_string(i - 1) + ";";
        laughs += "<!ENTITY " + (i == 8 ? std::string("field") : "a" + std::to_string(i)) + " \"" + ten + "\">";
    }
    for (const std::string& endless : {laughs, std::string("<!ENTITY field \"&field;\">")})
        EXPECT_THAT(error_of([&] { static_cast<void>(with(endless)); }), HasSubstr("its entities make much more text"));
}

TEST_F(Xdmf, MixedCellsAreTakenByTheirTypes) {
    HexMesh mesh = make_box(1, 1, 1);
    mesh.points.insert(mesh.points.end(), {{.5, .5, 2}, {2, 0, 0}, {2, 0, 1}});
    const std::vector<int> cells{9, 0, 1,  3, 2, 4, 5,  7, 6, 7, 4, 5, 7, 6, 8, 8, 1, 9,
                                 3, 5, 10, 7, 6, 5, 10, 7, 8, 2, 2, 0, 1, 5, 0, 1, 3, 2};
    const ReadResult result = read(grid("<Topology TopologyType=\"Mixed\">" + item(cells, std::to_string(cells.size())) +
                                        "</Topology>" + geometry(mesh) + array("c", "Cell", {1, 2, 3, 4, 5, 6})));
    EXPECT_NEAR(inspect(result.mesh).volume, 1 + 1. / 3 + .5 + 1. / 6, 1e-12);
    EXPECT_THAT(result.warnings, Contains(HasSubstr("1 hexahedron, 1 tetrahedron, 1 prism and 1 pyramid")));
}

TEST_F(Xdmf, StructuredGridsCountZFirst) {
    const HexMesh mesh = make_box(3, 2, 1);
    std::vector<double> x(24);
    for (std::size_t p = 0; p < 24; ++p) x[p] = mesh.points[p].x;
    const std::string field = "<Attribute Name=\"x\" Center=\"Node\">" + item(x, "2 3 4") + "</Attribute>";
    const std::string cuts =
        item(std::vector{0, 1, 2, 3}, "4") + item(std::vector{0, 1, 2}, "3") + item(std::vector{0, 1}, "2");
    for (const std::string& content :
         {"<Topology TopologyType=\"3DSMesh\" Dimensions=\"2 3 4\"/>" + geometry(mesh),
          "<Topology TopologyType=\"3DRectMesh\" Dimensions=\"2 3 4\"/><Geometry GeometryType=\"VXVYVZ\">" + cuts +
              "</Geometry>",
          "<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"2 3 4\"/><Geometry GeometryType=\"ORIGIN_DXDYDZ\">" +
              item(std::vector{0, 0, 0}, "3") + item(std::vector{1, 1, 1}, "3") + "</Geometry>"}) {
        const ReadResult result = read(grid(content + field));
        EXPECT_EQ(result.mesh.points, mesh.points);
        EXPECT_EQ(result.mesh.cells, mesh.cells);
        for (std::size_t p = 0; p < 24; ++p) EXPECT_EQ(result.mesh.attributes[0].values[p], mesh.points[p].x);
    }
}

TEST_F(Xdmf, StepsAreInTheOrderOfTheirTimesAndShareTheirMesh) {
    const HexMesh mesh = make_box(1, 1, 1);
    const auto step = [&](double time, double value) {
        return grid(
            "<ns0:include xpointer=\"xpointer(//Grid[@Name=&quot;mesh&quot;]/*[self::Topology or self::Geometry])\"/>"
            "<Time Value=\"" +
            number(time) + "\"/>" + array("T", "Node", std::vector<double>(8, value)));
    };
    const std::string common = grid(topology(mesh) + geometry(mesh), "Name=\"mesh\" GridType=\"Uniform\"");
    write("a.xdmf", document(common + grid(step(1, 10) + step(0, 0) + step(.5, 5), kTemporal)));
    EXPECT_THAT(open_series(path("a.xdmf")).times, ElementsAre(0, .5, 1));
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(read_mesh(path("a.xdmf"), {.step = k}).mesh.attributes[0].values[0], 5. * static_cast<double>(k));
    }
    EXPECT_THAT(read_mesh(path("a.xdmf")).warnings, ElementsAre("the file has 3 steps; the last one is read"));
    // Times in one list; cells and points in the first step alone.
    const auto plain = [&](double value) { return grid(array("T", "Node", std::vector<double>(8, value))); };
    write("a.xdmf",
          document(grid("<Time TimeType=\"List\">" + item(std::vector<double>{2, 4}, "2") + "</Time>" +
                            grid(topology(mesh) + geometry(mesh) + array("T", "Node", std::vector<double>(8, 1))) + plain(7),
                        kTemporal)));
    EXPECT_THAT(open_series(path("a.xdmf")).times, ElementsAre(2, 4));
    EXPECT_EQ(read_mesh(path("a.xdmf")).mesh.attributes[0].values[0], 7);
}

TEST_F(Xdmf, SpatialCollectionsAreJoined) {
    const HexMesh mesh = make_box(1, 1, 1);
    const std::string parts = grid(topology(mesh) + geometry(mesh)) + grid(topology(mesh) + geometry(mesh, {1, 0, 0}));
    const ReadResult result = read(grid(parts, "GridType=\"Collection\" CollectionType=\"Spatial\""));
    EXPECT_EQ(inspect(result.mesh).points_used, 12u);
    EXPECT_THAT(result.warnings, ElementsAre("2 grids put together; 4 points joined with those of another, by their places"));
}

TEST_F(Xdmf, ValuesInBinaryFilesAndPartsOfThem) {
    const HexMesh mesh = make_box(1, 1, 1);
    const std::vector<float> values{9, 9, 0, 1, 2, 3, 4, 5, 6, 7};
    write("t.bin", std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)));
    const std::string whole =
        "<DataItem Dimensions=\"10\" Format=\"Binary\" Precision=\"4\" NumberType=\"Float\">t.bin</DataItem>";
    const std::string later = "<DataItem Dimensions=\"8\" Format=\"Binary\" Precision=\"4\" Seek=\"8\">t.bin</DataItem>";
    const std::string slab =
        "<DataItem ItemType=\"HyperSlab\" Dimensions=\"8\">" + item(std::vector{2, 1, 8}, "3 1") + whole + "</DataItem>";
    for (const std::string& values_of : {later, slab}) {
        const ReadResult result =
            read(grid(topology(mesh) + geometry(mesh) + "<Attribute Name=\"T\" Center=\"Node\">" + values_of + "</Attribute>"));
        EXPECT_THAT(result.mesh.attributes[0].values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
    }
}

// A slab is checked by division: its last place may be beyond any 64-bit number.
TEST_F(Xdmf, SlabsBeyondTheirValuesAreRefused) {
    const HexMesh mesh = make_box(1, 1, 1);
    const auto attribute = [&](const std::string& place, const std::string& rank, const std::string& values) {
        return grid(topology(mesh) + geometry(mesh) +
                    "<Attribute Name=\"T\" Center=\"Node\"><DataItem ItemType=\"HyperSlab\"><DataItem Dimensions=\"3 " + rank +
                    "\">" + place + "</DataItem>" + values + "</DataItem></Attribute>");
    };
    const std::string line = item(std::vector{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}, "16");
    EXPECT_THAT(read(attribute("1 2 8", "1", line)).mesh.attributes[0].values, ElementsAre(1, 3, 5, 7, 9, 11, 13, 15));
    const std::string table = item(std::vector{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}, "8 2");
    EXPECT_THAT(read(attribute("0 1 1 1 8 1", "2", table)).mesh.attributes[0].values, ElementsAre(1, 3, 5, 7, 9, 11, 13, 15));
    const std::string outside = "the hyperslab does not lie in its values";
    for (const std::string place :
         {"2 2 8", "0 3 8", "9 1 8", "16 1 1", "0 549755813888 9", "0 999999999999 16", "999999999999 1 1"})
        EXPECT_THAT(error(attribute(place, "1", line)), HasSubstr(outside)) << place;
    EXPECT_THAT(error(attribute("0 0 1 1 9 1", "2", table)), HasSubstr(outside));
    EXPECT_THAT(error(attribute("0 2 1 1 8 1", "2", table)), HasSubstr(outside));
    EXPECT_THAT(error(attribute("0 0 1 549755813888 8 3", "2", table)), HasSubstr(outside));
    EXPECT_THAT(error(attribute("1 2 8", "1", table)), HasSubstr("its rank differs from that of the values"));
    EXPECT_THAT(error(attribute("0 0 0 1 1 1 4294967296 4294967296 4294967296", "3",
                                "<DataItem Dimensions=\"4294967296 4294967296 4294967296\">1</DataItem>")),
                HasSubstr("Dimensions say"));
}

// The paths of writers: ParaView's, Xdmf3's and dolfin's.
TEST_F(Xdmf, PathsLeadToElementsOfTheFile) {
    const HexMesh mesh = make_box(1, 1, 1);
    const auto values = [](double value) { return item(std::vector<double>(8, value), "8"); };
    const auto named = [&](const std::string& name, double value) {
        return replaced(values(value), "<DataItem ", "<DataItem Name=\"" + name + "\" ");
    };
    const std::string common = named("a", 1) + named("b [2]", 2) + named("a", 3);
    const auto value_at = [&](const std::string& reference) {
        const ReadResult result = read(common + grid(topology(mesh) + geometry(mesh) +
                                                     "<Attribute Name=\"T\" Center=\"Node\">" + reference + "</Attribute>"));
        return result.mesh.attributes[0].values[0];
    };
    const auto by_attribute = [&](const std::string& path) { return value_at("<DataItem Reference='" + path + "'/>"); };
    EXPECT_EQ(by_attribute("/Xdmf/Domain/DataItem"), 1);
    EXPECT_EQ(by_attribute("/Xdmf/Domain/DataItem[2]"), 2);
    EXPECT_EQ(by_attribute("/Xdmf/Domain/DataItem[@Name=\"a\"][2]"), 3);
    EXPECT_EQ(by_attribute("/Xdmf/Domain/DataItem[ @Name = \"b [2]\" ]"), 2);
    EXPECT_EQ(by_attribute("/Xdmf/Domain/*[3]"), 3);
    EXPECT_EQ(by_attribute("/Xdmf/Domain/*[self::DataItem][2]"), 2);
    EXPECT_EQ(by_attribute("//DataItem[@Name=\"b [2]\"]"), 2);
    EXPECT_EQ(by_attribute("//Domain/DataItem[3]"), 3);
    EXPECT_EQ(value_at("<DataItem Reference=\"XML\">/Xdmf/Domain/DataItem[3]</DataItem>"), 3);
    EXPECT_EQ(value_at("<DataItem reference=\"XML\"> /Xdmf/Domain/DataItem[@Name=\"b [2]\"] </DataItem>"), 2);
    const auto error_at = [&](const std::string& path) { return error_of([&] { static_cast<void>(by_attribute(path)); }); };
    for (const std::string path : {"/Xdmf/Domain/DataItem[4]", "/Xdmf/Domain/DataItem[@Name=\"c\"]", "/Domain", "//Nothing"})
        EXPECT_THAT(error_at(path), HasSubstr("there is no element")) << path;
    for (const std::string path :
         {"", "DataItem", "/", "/Xdmf//DataItem", "/Xdmf/..", "/Xdmf/Domain/DataItem[0]", "/Xdmf/Domain/DataItem[", "/Xdmf[",
          "/Xdmf/Domain/DataItem[last()]", "/*/*/*[count(/*/*/*)=9]", "/Xdmf/Domain/DataItem[@Name=a]", "/Xdmf/Domain/[1]",
          "/Xdmf/Domain/DataItem[99999999999999999999]", "/Xdmf/Domain/DataItem|/Xdmf/Domain/DataItem"})
        EXPECT_THAT(error_at(path), HasSubstr("not a part of this file, or no plain path")) << path;
}

TEST_F(Xdmf, ValuesMayBeFunctionsOfOthers) {
    const HexMesh mesh = make_box(1, 1, 1);
    const std::vector<double> a{0, 1, 2, 3, 4, 5, 6, 7}, b{9, 9, 9, 9, 9, 9, 9, 9};
    const auto function = [&](const std::string& text, const std::string& sizes, const std::string& type) {
        return "<Attribute Name=\"f\" Center=\"Node\" AttributeType=\"" + type +
               "\"><DataItem ItemType=\"Function\" Function=\"" + text + "\" Dimensions=\"" + sizes + "\">" + item(a, "8") +
               item(b, "8") + "</DataItem></Attribute>";
    };
    const auto value = [&](const std::string& text) {
        const ReadResult result = read(grid(topology(mesh) + geometry(mesh) + function(text, "8", "Scalar")));
        return result.mesh.find_attribute("f")->values[5];
    };
    EXPECT_EQ(value("$0+$1"), 14);
    EXPECT_EQ(value("2 - $0 * ($1 - 7) / 2.5e0"), -2);
    EXPECT_EQ(value("-sqrt($1) + ABS(0-$0)"), 2);
    const ReadResult joined = read(grid(topology(mesh) + geometry(mesh) + function("JOIN($0; $1; 2*$0)", "8 3", "Vector")));
    EXPECT_EQ(joined.mesh.find_attribute("f")->values[3 * 5 + 2], 10);
    EXPECT_EQ(joined.mesh.find_attribute("f")->values[3 * 5 + 1], 9);
    for (const std::string bad : {"$2", "$0 +", "WHERE($0)", "(", "", "$0 $1", "JOIN($0; 1)"}) {
        const ReadResult left =
            read(grid(topology(mesh) + geometry(mesh) + function(bad, "8", "Scalar") + array("T", "Node", a)));
        ASSERT_EQ(left.unread.size(), 1u) << bad;
        EXPECT_EQ(left.fields.size(), 1u);
        EXPECT_THAT(error(grid(topology(mesh) + geometry(mesh) + function(bad, "8", "Scalar"))), HasSubstr("a.xdmf, line"))
            << bad;
    }
}

TEST_F(Xdmf, WrongFilesGetASentenceWithTheLine) {
    const HexMesh mesh = make_box(1, 1, 1);
    EXPECT_THAT(error(""), HasSubstr("a.xdmf, line 3: it has no grids"));
    EXPECT_THAT(error(grid(geometry(mesh))), HasSubstr("the grid has no Topology"));
    EXPECT_THAT(error(grid(topology(mesh) + geometry(mesh) + array("T", "Node", {1, 2, 3}))),
                HasSubstr("array \"T\" has 3 values for 8 points"));
    EXPECT_THAT(error(grid("<Topology TopologyType=\"Hexahedron\">" + item(std::vector{0, 1, 2, 3, 4, 5, 6, 8}, "8") +
                           "</Topology>" + geometry(mesh))),
                HasSubstr("cell 0: there is no point with index 8 (there are 8 points)"));
    EXPECT_THAT(error(grid("<Topology TopologyType=\"Mixed\">" + item(std::vector{77}, "1") + "</Topology>" + geometry(mesh))),
                HasSubstr("cell 0 is of type 77"));
    EXPECT_THAT(error(grid("<Topology TopologyType=\"2DSMesh\"/>" + geometry(mesh))),
                HasSubstr("\"2DSMESH\" are not supported"));
    EXPECT_THAT(error(grid("<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"9000 9000 9\"/><Geometry "
                           "GeometryType=\"ORIGIN_DXDYDZ\"/>")),
                HasSubstr("its points are more than its values"));
    const std::string plane = "<DataItem Reference=\"/Xdmf/Domain/DataItem\"/>";
    std::string planes;
    for (int k = 0; k < 1000; ++k) planes += std::to_string(k) + " ";
    EXPECT_THAT(error("<DataItem Dimensions=\"1000\">" + planes + "</DataItem>" +
                      grid("<Topology TopologyType=\"3DRectMesh\" Dimensions=\"1000 1000 1000\"/><Geometry>" + plane + plane +
                           plane + "</Geometry>")),
                HasSubstr("its points are more than its values"));
    const std::string heavy = "<Geometry GeometryType=\"XYZ\"><DataItem Dimensions=\"8 3\" Format=\"HDF\">";
    EXPECT_THAT(error(grid(topology(mesh) + heavy + "a.h5:/x</DataItem></Geometry>")), HasSubstr("there is no file \"a.h5\""));
    EXPECT_THAT(error(grid("<Topology Reference=\"//Grid//Grid//*\"/>" + geometry(mesh))),
                HasSubstr("not a part of this file"));
    EXPECT_THAT(error(grid("<Topology Reference=\"/Xdmf/Domain/Grid/Topology\"/>" + geometry(mesh))),
                HasSubstr("elements refer to each other"));
    write("no.xmf", "<Xdmf>");
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("no.xmf"))); }), HasSubstr("not well-formed XML"));
    // The parser finds this wrong behind the last byte.
    write("cut.xmf",
          "<Xdmf><Domain><Grid GridType=\"Coll<Xdmf><Domain><Grid Gridection\" CollectionTType=\"Collection\" Colylec0");
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("cut.xmf"))); }), HasSubstr("line 1: not well-formed XML"));
}

using XdmfFuzz = MeshFuzz;

TEST_F(XdmfFuzz, StepsAndMixedCells) {
    const HexMesh mesh = make_box(1, 1, 1);
    const std::string step =
        grid(topology(mesh) + geometry(mesh) + "<Time Value=\"1\"/>" + array("T", "Node", {1, 2, 3, 4, 5, 6, 7, 8}));
    const std::string mixed =
        grid("<Topology TopologyType=\"Mixed\">" + item(std::vector{9, 0, 1, 3, 2, 4, 5, 7, 6, 1, 1, 0}, "12") + "</Topology>" +
             geometry(mesh) + array("c", "Cell", {1, 2}));
    expect_sound_or_refused(".xdmf", document(grid(step + mixed, kTemporal)), 31);
    expect_sound_or_refused(".xdmf",
                            document(grid("<Topology TopologyType=\"3DSMesh\" Dimensions=\"2 2 2\"/>" + geometry(mesh))), 32);
}

}  // namespace xdmf_test

}  // namespace subvol::test
