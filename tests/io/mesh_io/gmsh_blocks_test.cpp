// SPDX-License-Identifier: Apache-2.0
// Gmsh, versions 4.0 and 4.1, whose nodes and elements come in blocks; binary files; curved elements; fields at elements.

#include <gmock/gmock.h>

#include "binary_texts.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "mesh_texts.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace gmsh_blocks_test {

using testing::ElementsAre;
using testing::HasSubstr;

const HexMesh kBox = make_box(2, 1, 1);

// The nodes get the numbers 10, 20, 30…, the hexahedra 7 and 5.
std::string corners_of(std::size_t cell) {
    std::string text;
    for (const Index p : kBox.cells[cell]) text += " " + std::to_string(10 * (p + 1));
    return text + "\n";
}

std::string place_of(std::size_t p) {
    return number(kBox.points[p].x) + " " + number(kBox.points[p].y) + " " + number(kBox.points[p].z);
}

std::string ascii_41() {
    std::string text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n1 0 0 0\n1 0 0 0 0\n$EndEntities\n";
    text += "$Nodes\n3 12 10 120\n0 1 0 1\n10\n" + place_of(0) + "\n1 1 1 2\n20\n30\n";
    text += place_of(1) + " 0.25\n" + place_of(2) + " 0.5\n3 1 0 9\n";
    for (std::size_t p = 3; p < 12; ++p) text += std::to_string(10 * (p + 1)) + "\n";
    for (std::size_t p = 3; p < 12; ++p) text += place_of(p) + "\n";
    text += "$EndNodes\n$Elements\n2 3 5 9\n2 1 3 1\n9 10 20 50 40\n3 1 5 2\n7" + corners_of(0) + "5" + corners_of(1);
    return text + "$EndElements\n";
}

std::string ascii_40() {
    std::string text = "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n2 12\n1 2 1 1\n10 " + place_of(0) + " 0.5 0.5\n1 3 0 11\n";
    for (std::size_t p = 1; p < 12; ++p) text += std::to_string(10 * (p + 1)) + " " + place_of(p) + "\n";
    return text + "$EndNodes\n$Elements\n2 3\n1 2 3 1\n9 10 20 50 40\n1 3 5 2\n7" + corners_of(0) + "5" + corners_of(1) +
           "$EndElements\n";
}

// Collects binary numbers.
struct Bytes {
    std::endian order = std::endian::little;
    std::string text{};

    template <class T>
    Bytes& add(std::initializer_list<T> values) {
        text += bytes_of(std::vector<T>(values), order);
        return *this;
    }
};

template <class Number>
void add_corners(Bytes& bytes, std::size_t cell) {
    for (const Index p : kBox.cells[cell]) bytes.add<Number>({static_cast<Number>(10 * (p + 1))});
}

std::string binary_41(std::endian order) {
    using Size = std::uint64_t;
    Bytes nodes{order}, elements{order};
    nodes.add<Size>({1, 12, 10, 120}).add({3, 1, 0}).add<Size>({12});
    for (Size p = 0; p < 12; ++p) nodes.add<Size>({10 * (p + 1)});
    for (const Vec3& x : kBox.points) nodes.add({x.x, x.y, x.z});
    elements.add<Size>({2, 3, 5, 9}).add({2, 1, 3}).add<Size>({1, 9, 10, 20, 50, 40}).add({3, 1, 5}).add<Size>({2, 7});
    add_corners<Size>(elements, 0);
    elements.add<Size>({5});
    add_corners<Size>(elements, 1);
    return "$MeshFormat\n4.1 1 8\n" + Bytes{order}.add({1}).text + "\n$EndMeshFormat\n$Entities\n" + std::string(32, '\0') +
           "\n$EndEntities\n$Nodes\n" + nodes.text + "\n$EndNodes\n$Elements\n" + elements.text + "\n$EndElements\n";
}

std::string binary_2(std::endian order) {
    Bytes nodes{order}, elements{order};
    for (int p = 0; p < 12; ++p) {
        const Vec3& x = kBox.points[static_cast<std::size_t>(p)];
        nodes.add({10 * (p + 1)}).add({x.x, x.y, x.z});
    }
    elements.add({3, 1, 2, 9, 0, 0, 10, 20, 50, 40}).add({5, 2, 1, 7, 3});
    add_corners<int>(elements, 0);
    elements.add({5, 3});
    add_corners<int>(elements, 1);
    return "$MeshFormat\n2.2 1 8\n" + Bytes{order}.add({1}).text + "\n$EndMeshFormat\n$Nodes\n12\n" + nodes.text +
           "\n$EndNodes\n$Elements\n3\n" + elements.text + "\n$EndElements\n";
}

class GmshBlocks : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& text) const { return read_mesh(write("a.msh", text)); }
    [[nodiscard]] std::string read_error(const std::string& text) const {
        return error_of([&] { static_cast<void>(read(text)); });
    }
};

TEST_F(GmshBlocks, EveryVersionAndEncodingIsTheSameMesh) {
    for (const std::string& text : {ascii_40(), ascii_41(), binary_41(std::endian::little), binary_41(std::endian::big),
                                    binary_2(std::endian::little), binary_2(std::endian::big)}) {
        const ReadResult result = read(text);
        EXPECT_EQ(result.mesh.points, kBox.points);
        EXPECT_EQ(result.mesh.cells, kBox.cells);
        EXPECT_THAT(result.warnings, ElementsAre("1 quad ignored"));
    }
}

TEST_F(GmshBlocks, FieldsAtNodesAndElements) {
    const std::string head = "1\n\"e\"\n1\n0.5\n3\n0\n1\n2\n";
    const std::string of_elements = "$ElementData\n" + head + "5 50\n7 70\n$EndElementData\n";
    const std::string of_binary =
        "$ElementData\n" + head + Bytes{}.add({5}).add({50.0}).add({7}).add({70.0}).text + "\n$EndElementData\n";
    std::string of_nodes = "$NodeData\n1\n\"n\"\n0\n3\n0\n1\n12\n";
    for (int n = 1; n <= 12; ++n) of_nodes += std::to_string(10 * n) + " " + std::to_string(n) + "\n";
    of_nodes += "$EndNodeData\n";
    for (const std::string& text : {ascii_40() + of_nodes + of_elements, ascii_41() + of_elements + of_nodes,
                                    binary_41(std::endian::little) + of_binary, binary_2(std::endian::little) + of_binary}) {
        const ReadResult result = read(text);
        const Attribute* e = result.mesh.find_attribute("e");
        ASSERT_NE(e, nullptr);
        EXPECT_EQ(e->values[0], 70);
        EXPECT_EQ(e->values[1], 60);
        EXPECT_EQ(e->values[2], 50);
        const Attribute* n = result.mesh.find_attribute("n");
        if (n != nullptr) {
            EXPECT_EQ(n->values[11], 12);
        }
    }
    EXPECT_THAT(read_error(ascii_41() + replaced(of_elements, "7 70", "8 70")), HasSubstr("line 2: there is no element 8"));
    EXPECT_THAT(read_error(replaced(ascii_41(), "$Elements", of_elements + "$Elements")),
                HasSubstr("$ElementData come before"));
}

TEST_F(GmshBlocks, OfCurvedElementsTheCornersAreTaken) {
    for (const auto& [type, nodes] : std::vector<std::pair<int, int>>{{12, 27}, {17, 20}, {92, 64}}) {
        const HexMesh cell = make_box(1, 1, 1);
        std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(nodes) + "\n";
        for (int n = 1; n <= nodes; ++n) {
            const Vec3 x = n <= 8 ? cell.points[static_cast<std::size_t>(n - 1)] : Vec3(0.5);
            text += std::to_string(n) + " " + number(x.x) + " " + number(x.y) + " " + number(x.z) + "\n";
        }
        text += "$EndNodes\n$Elements\n1\n1 " + std::to_string(type) + " 0 1 2 4 3 5 6 8 7";
        for (int n = 9; n <= nodes; ++n) text += " " + std::to_string(n);
        const ReadResult result = read_mesh(write("a.msh", text + "\n$EndElements\n"), {.curved_tolerance = std::nullopt});
        EXPECT_THAT(result.warnings, ElementsAre("1 element has more nodes than corners: only the corners are used"));
        EXPECT_EQ(inspect(result.mesh).volume, 1);
        EXPECT_EQ(inspect(result.mesh).points_used, 8u);
    }
}

TEST_F(GmshBlocks, ErrorsNameThePlace) {
    const std::string good = ascii_41();
    const std::vector<std::array<std::string, 3>> cases{
        {"3 12 10 120", "3 13 10 120", "$Nodes: its blocks have 12, but it announces 13"},
        {"3 12 10 120", "3 11 10 120", "more than the 11 announced"},
        {"3 12 10 120", "3 999999999999 10 120", "$Nodes: count out of range: 999999999999"},
        {"1 1 1 2", "1 1 1 -2", "block of $Nodes: negative count -2"},
        {"1 1 1 2", "7 1 1 2", "a block of $Nodes is of dimension 7"},
        {"\n30\n", "\n20\n", "there are two nodes 20"},
        {"2 3 5 9", "2 4 5 9", "$Elements: its blocks have 3, but it announces 4"},
        {"2 3 5 9", "2 2 5 9", "$Elements: its blocks have more than the 2 announced"},
        {"3 1 5 2", "3 1 99 2", "element 2 is of the unknown type 99"},
        {"\n7 10 ", "\n7 11 ", "element 2: there is no node 11"},
    };
    for (const auto& [from, to, message] : cases) {
        EXPECT_THAT(read_error(replaced(good, from, to)), HasSubstr(message)) << from << " -> " << to;
    }
    EXPECT_THAT(read_error(replaced(binary_2(std::endian::little), "2.2 1 8", "2.2 1 4")), HasSubstr("numbers of 4 bytes"));
}

TEST_F(GmshBlocks, CutAnywhereItIsRefused) {
    for (const std::string& text : {binary_41(std::endian::little), binary_2(std::endian::big), ascii_40()}) {
        const std::size_t end = text.rfind("$EndElements");
        for (std::size_t length = 0; length < end; length += 3)
            EXPECT_NE(read_error(text.substr(0, length)), "no error") << length;
    }
}

}  // namespace gmsh_blocks_test

}  // namespace subvol::test
