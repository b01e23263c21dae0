// SPDX-License-Identifier: Apache-2.0
// Exodus II in each version of netCDF's classic format.

#include <gmock/gmock.h>

#include <limits>

#include "exodus_expected.h"
#include "io/mesh_io/mesh_damage.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace exodus_io_test {

using testing::ElementsAre;
using testing::HasSubstr;

const HexMesh kBox = make_box(2, 2, 1);
constexpr std::size_t kPoints = 18;

ExodusText two_blocks() {
    return test::two_blocks(kBox);
}

class ExodusIo : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const ExodusText& file, const ReadOptions& options = {}) const {
        return read_mesh(write("a.exo", exodus_text(file)), options);
    }
    [[nodiscard]] std::string read_error(const std::string& bytes) const {
        return error_of([&] { static_cast<void>(read_mesh(write("a.exo", bytes))); });
    }
    [[nodiscard]] std::string read_error(const ExodusText& file) const { return read_error(exodus_text(file)); }
};

TEST_F(ExodusIo, EveryVersionGivesTheMeshAndTheFieldsOfTheLastStep) {
    for (const int version : {1, 2, 5}) {
        for (const bool old_names : {false, true}) {
            ExodusText file = two_blocks();
            file.version = version;
            file.old_names = old_names;
            expect_two_blocks(read(file), kBox);
        }
    }
}

TEST_F(ExodusIo, ScalarsThatAreComponentsBecomeTensorsAndVectors) {
    // As MOOSE writes a tensor, of which the first three in a row are no vector; and a vector in another order.
    ExodusText file{.points = kBox.points, .blocks = {hex_block(kBox)}, .times = {0}};
    for (const std::string name : {"s_xx", "s_xy", "s_xz", "s_yy", "s_yz", "s_zz", "T", "u_z", "u_x", "u_y"}) {
        file.of_nodes.emplace_back(name, std::vector<double>(kPoints, static_cast<double>(file.of_nodes.size())));
    }
    const HexMesh mesh = read(file).mesh;
    ASSERT_EQ(mesh.attributes.size(), 3u);
    const auto first = [&](const std::string& name, std::size_t count) {
        const std::vector<double>& values = mesh.find_attribute(name)->values;
        return std::vector<double>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
    };
    EXPECT_THAT(first("s", 6), ElementsAre(0, 3, 5, 1, 4, 2)) << "xx, yy, zz, xy, yz, xz";
    EXPECT_THAT(first("u", 3), ElementsAre(8, 9, 7));
    EXPECT_THAT(first("T", 1), ElementsAre(6));
}

TEST_F(ExodusIo, EveryNameOfSuchAFile) {
    for (const std::string name : {"a.e", "a.exo", "a.ex2", "a.g", "a.EXO"}) {
        const ReadResult result = read_mesh(write(name, exodus_text({.points = kBox.points, .blocks = {hex_block(kBox)}})));
        EXPECT_EQ(result.mesh.cells, kBox.cells);
        EXPECT_TRUE(result.warnings.empty());
    }
}

TEST_F(ExodusIo, PiecesAreJoined) {
    for (const std::size_t k : {0u, 1u}) {
        ExodusText half{.points = kBox.points, .blocks = {hex_block(kBox)}, .times = {0}};
        for (Vec3& x : half.points) x.x += 2. * static_cast<double>(k);
        half.of_nodes = {{"T", std::vector<double>(kPoints, static_cast<double>(k))}};
        write("m.e.2." + std::to_string(k), exodus_text(half));
    }
    for (const std::string name : {"m.e.2.0", "m.e.2.1"}) {
        const ReadResult result = read_mesh(path(name));
        EXPECT_EQ(result.mesh.cells.size(), 2 * kBox.cells.size());
        EXPECT_EQ(result.mesh.points.size(), 2 * kPoints - 6);
        ASSERT_EQ(result.blocks.size(), 1u);
        EXPECT_EQ(result.blocks[0].cells, 2 * kBox.cells.size());
        EXPECT_EQ(result.fields.at(0).max, 1);
    }
    std::filesystem::remove(path("m.e.2.1"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path("m.e.2.0"))); }, ErrorCode::Io),
                HasSubstr("m.e.2.1: cannot be read"));
}

TEST_F(ExodusIo, CurvedCellsGiveTheirCorners) {
    const HexMesh cube = make_box(1, 1, 1);
    for (const std::size_t nodes : {20u, 27u}) {
        ExodusBlock block{"HEX" + std::to_string(nodes), nodes, hex_block(cube).connectivity};
        block.connectivity.resize(nodes, 1);
        const std::string text = exodus_text({.points = cube.points, .blocks = {block}});
        const ReadResult result = read_mesh(write("a.exo", text), {.curved_tolerance = std::nullopt});
        EXPECT_EQ(result.mesh.cells, cube.cells);
        EXPECT_THAT(result.warnings, ElementsAre("1 element has more nodes than corners: only the corners are used"));
    }
}

TEST_F(ExodusIo, OtherCellsAreSplitOrLeftOutWithTheirValues) {
    ExodusText file{.points = make_box(1, 1, 1).points, .blocks = {}, .times = {0}};
    file.points.insert(file.points.end(), {{.5, .5, 2}, {2, .5, 0}, {2, .5, 1}});
    file.blocks = {{"SHELL4", 4, {1, 2, 4, 3}},
                   {"PYRAMID5", 5, {5, 6, 8, 7, 9}},
                   hex_block(make_box(1, 1, 1)),
                   {"WEDGE6", 6, {2, 10, 4, 6, 11, 8}},
                   {"TETRA4", 4, {6, 11, 8, 9}}};
    file.of_elements = {{"e", {{9}, {1}, {2}, {3}, {4}}}};
    const ReadResult split = read(file);
    EXPECT_THAT(split.warnings[0], HasSubstr("1 element of type \"SHELL4\" ignored"));
    EXPECT_THAT(split.warnings[1], HasSubstr("1 hexahedron, 1 tetrahedron, 1 prism and 1 pyramid"));
    EXPECT_NEAR(inspect(split.mesh).volume, 1 + 1.0 / 3 + 0.5 + 1.0 / 6, 1e-12);  // rounding
    EXPECT_EQ(split.fields[0].min, 1);
    const ReadResult alone = read(file, {.other_cells = OtherCells::Ignore});
    EXPECT_EQ(alone.mesh.cells.size(), 1u);
    EXPECT_EQ(alone.mesh.find_attribute("e")->values[0], 2);
    EXPECT_THAT(alone.warnings[0], HasSubstr("1 element of type \"TETRA4\", 1 element of type \"WEDGE6\" ignored"));
}

TEST_F(ExodusIo, WrongFilesGetASentenceWithTheElementOrNode) {
    EXPECT_THAT(read_error(""), HasSubstr("a.exo: the file is empty"));
    EXPECT_THAT(read_error("no mesh"), HasSubstr("a.exo: not an Exodus II file"));
    EXPECT_THAT(read_error("CDF\x01"), HasSubstr("a.exo, byte 4: records: unexpected end of file"));
    EXPECT_THAT(read_error("CDF\x03____"), HasSubstr("this version of netCDF's classic format is not supported"));
    EXPECT_THAT(read_error("\x89HDF"), HasSubstr("a.exo: not an HDF5 file"));
    NetcdfText other;
    other.dimension("x", 3);
    EXPECT_THAT(read_error(other.text(1)), HasSubstr("not an Exodus II file, or it has no nodes"));
    const auto with_corner = [&](int node) {
        ExodusText file = two_blocks();
        file.blocks[1].connectivity[3] = node;
        return read_error(file);
    };
    EXPECT_THAT(with_corner(0), HasSubstr("a.exo: element 4: there is no node 0 (nodes are 1 to 18)"));
    EXPECT_THAT(with_corner(19), HasSubstr("element 4: there is no node 19"));
    EXPECT_THAT(with_corner(two_blocks().blocks[1].connectivity[1]),
                HasSubstr("twice, at corners that no collapsed edge joins (a cell may repeat a point only along its edges)"));
    EXPECT_THAT(with_corner(two_blocks().blocks[1].connectivity[1]), HasSubstr("a.exo: element 4 has node "));
    EXPECT_EQ(with_corner(two_blocks().blocks[1].connectivity[2]), "no error") << "an edge of no length is allowed";
    ExodusText file = two_blocks();
    file.points[4].y = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(read_error(file), HasSubstr("a.exo: non-finite coordinate at node 5"));
    file = two_blocks();
    file.of_nodes[3].second[kPoints + 2] = std::numeric_limits<double>::infinity();
    EXPECT_THAT(read_error(file), HasSubstr("no error"));
    file = two_blocks();
    file.blocks[0] = {"HEX8", 4, {1, 2, 3, 4}};
    file.of_elements.clear();
    EXPECT_THAT(read_error(file), HasSubstr("block 1 of type \"HEX8\" has 4 nodes an element (a hexahedron has 8)"));
    EXPECT_THAT(read_error(ExodusText{.points = kBox.points, .blocks = {{"QUAD", 4, {1, 2, 4, 3}}}}),
                HasSubstr("no hexahedra, but 1 element of type \"QUAD\""));
}

TEST_F(ExodusIo, EveryStepAndEveryBlockIsRead) {
    const ExodusText file = two_blocks();
    const auto path = write("a.exo", exodus_text(file));
    const MeshSeries series = open_series(path);
    EXPECT_EQ(series.times, file.times);
    for (std::size_t k = 0; k < series.size(); ++k) {
        const ReadResult result = read_mesh(path, {.step = k});
        EXPECT_EQ(result.mesh.find_attribute("T")->values, count_from(3 + static_cast<double>(k) * kPoints, kPoints));
    }
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path, {.step = 2})); }),
                HasSubstr("a.exo: there is no step 2 (steps are 0 to 1)"));
    const ReadResult all = read_mesh(path);
    ASSERT_EQ(all.blocks.size(), 2u);
    EXPECT_EQ(all.blocks[0].cells + all.blocks[1].cells, all.mesh.cells.size());
    const ReadResult second = read_mesh(path, {.blocks = {all.blocks[1].name}});
    EXPECT_EQ(second.mesh.cells.size(), all.blocks[1].cells);
    EXPECT_EQ(second.mesh.cells.back(), all.mesh.cells.back());
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(path, {.blocks = {"x"}})); }),
                HasSubstr("a.exo: there is no block \"x\" (it has: block 1, block 2)"));
}

// The length of a dimension follows its name, which is padded to a multiple of four bytes.
std::string with_length(std::string bytes, const std::string& dimension, char high_byte) {
    bytes[bytes.find(dimension) + (dimension.size() + 3) / 4 * 4] = high_byte;
    return bytes;
}

TEST_F(ExodusIo, CountsAreBelievedAsFarAsTheFileIsLong) {
    const std::string good = exodus_text(two_blocks());
    for (const std::string dimension : {"num_nodes", "num_el_blk", "num_el_in_blk1", "num_nod_per_el2", "num_nod_var"}) {
        EXPECT_THAT(read_error(with_length(good, dimension, '\x10')),
                    testing::AnyOf(HasSubstr("count out of range"), HasSubstr("a record is longer than the file")))
            << dimension;
        EXPECT_THAT(read_error(with_length(good, dimension, '\x80')), HasSubstr("negative count")) << dimension;
    }
    // A variable's name is followed by its number of dimensions: netCDF's library allocates as many.
    EXPECT_THAT(read_error(with_length(good, "connect1", '\x10')), HasSubstr("netCDF: there is no dimension"));
    std::string records = good;
    records[5] = 1;  // 65538 steps
    EXPECT_THAT(read_error(records), HasSubstr("values go beyond the end of the file"));
    for (std::size_t cut = 0; cut < good.size(); cut += 37) {
        EXPECT_THAT(read_error(good.substr(0, cut)), HasSubstr("a.exo")) << cut;
    }
}

using ExodusFuzz = MeshFuzz;

TEST_F(ExodusFuzz, OfEachClassicFormat) {
    ExodusText file{.points = make_box(1, 1, 1).points, .blocks = {hex_block(make_box(1, 1, 1))}, .times = {0}};
    file.of_nodes = {{"s", count_from(0, 8)}};
    file.of_elements = {{"c", {{1}}}};
    unsigned seed = 50;
    for (const int version : {1, 2, 5}) {
        file.version = version;
        file.old_names = version == 1;
        expect_sound_or_refused(".exo", exodus_text(file), seed++);
    }
}

// A file that was written as a stream has all bits set as its number of records.
TEST_F(ExodusIo, StreamsOfRecords) {
    std::string bytes = exodus_text(two_blocks());
    for (std::size_t i = 4; i < 8; ++i) bytes[i] = '\xFF';
    EXPECT_EQ(read_mesh(write("a.e", bytes)).mesh.find_attribute("T")->values, count_from(3 + kPoints, kPoints));
}

}  // namespace exodus_io_test

}  // namespace subvol::test
