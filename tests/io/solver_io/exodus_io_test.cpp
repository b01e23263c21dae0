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
    EXPECT_THAT(split.warnings[0], HasSubstr("1 element of type SHELL4 ignored"));
    EXPECT_THAT(split.warnings[1], HasSubstr("1 hexahedron, 1 tetrahedron, 1 prism and 1 pyramid"));
    EXPECT_NEAR(inspect(split.mesh).volume, 1 + 1.0 / 3 + 0.5 + 1.0 / 6, 1e-12);  // rounding
    EXPECT_EQ(split.fields[0].min, 1);
    const ReadResult alone = read(file, {.other_cells = OtherCells::Ignore});
    EXPECT_EQ(alone.mesh.cells.size(), 1u);
    EXPECT_EQ(alone.mesh.find_attribute("e")->values[0], 2);
    EXPECT_THAT(alone.warnings[0], HasSubstr("1 element of type TETRA4, 1 element of type WEDGE6 ignored"));
}

// Two unit cubes and the prism of six sides beside them, by their faces: as Amanzi, MOAB and IOSS write them.
TEST_F(ExodusIo, PolyhedraAreReadByTheirFaces) {
    const double h = std::sqrt(3) / 2;
    std::vector<Vec3> points = make_box(2, 1, 1).points;
    const auto first = static_cast<int>(points.size());
    for (const double z : {0., 1.}) {
        for (const Vec3& x :
             {Vec3(1, 0, 0), Vec3(.5, h, 0), Vec3(-.5, h, 0), Vec3(-1, 0, 0), Vec3(-.5, -h, 0), Vec3(.5, -h, 0)})
            points.push_back(x + Vec3(5, 0, z));
    }
    std::vector<std::vector<int>> faces;
    std::vector<int> cells, counts;
    for (const auto& cell : make_box(2, 1, 1).cells) {
        for (const auto& side : {std::array{0, 3, 2, 1}, std::array{4, 5, 6, 7}, std::array{0, 1, 5, 4}, std::array{1, 2, 6, 5},
                                 std::array{2, 3, 7, 6}, std::array{3, 0, 4, 7}}) {
            auto& face = faces.emplace_back();
            for (const int k : side) face.push_back(static_cast<int>(cell[static_cast<std::size_t>(k)]) + 1);
            cells.push_back(static_cast<int>(faces.size()));
        }
        counts.push_back(6);
    }
    std::vector<int> below, above;
    for (int k = 0; k < 6; ++k) {
        const int a = first + 1 + k, b = first + 1 + (k + 1) % 6;
        faces.push_back({a, b, b + 6, a + 6});
        below.push_back(a);
        above.push_back(a + 6);
    }
    faces.push_back(below);
    faces.push_back(above);
    for (std::size_t f = 12; f < faces.size(); ++f) cells.push_back(static_cast<int>(f + 1));
    counts.push_back(8);
    const auto text = [&] {
        NetcdfText out;
        using Kind = NetcdfText::Kind;
        std::vector<int> nodes, of_faces;
        for (const auto& face : faces) {
            nodes.insert(nodes.end(), face.begin(), face.end());
            of_faces.push_back(static_cast<int>(face.size()));
        }
        out.dimension("num_dim", 3);
        out.dimension("num_el_blk", 1);
        out.dimension("num_fa_blk", 1);
        const auto of_points = out.dimension("num_nodes", points.size());
        const auto list = [&](const std::string& name, const std::string& size, const std::vector<int>& values) {
            const auto variable = out.variable(name, Kind::Integers, {out.dimension(size, values.size())});
            out.put(variable, values);
            return variable;
        };
        list("fbepecnt1", "num_fa_in_blk1", of_faces);
        list("fbconn1", "num_nod_per_fa1", nodes);
        list("ebepecnt1", "num_el_in_blk1", counts);
        out.attribute(list("facconn1", "num_fac_per_el1", cells), "elem_type", "NFACED");
        for (std::size_t a = 0; a < 3; ++a) {
            std::vector<double> along;
            for (const Vec3& x : points) along.push_back(x[static_cast<int>(a)]);
            out.put(out.variable(std::string("coord") + "xyz" [a], Kind::Reals, { of_points }), along);
        }
        return out.text(2);
    };
    const ReadResult result = read_mesh(write("a.exo", text()), {.crease_angle_deg = 0});
    EXPECT_NEAR(inspect(result.mesh).volume, 2 + 3 * h, 1e-12);
    EXPECT_EQ(read_mesh(write("a.exo", text()), {.other_cells = OtherCells::Ignore}).mesh.cells.size(), 2U);
    const auto error = [&] { return error_of([&] { static_cast<void>(read_mesh(write("b.exo", text()))); }); };
    cells[3] = 99;
    EXPECT_THAT(error(), HasSubstr("element 1: there is no face 99"));
    cells[3] = 4;
    faces[2][1] = 77;
    EXPECT_THAT(error(), HasSubstr("face 3: there is no node 77"));
    faces[2][1] = 1;
    counts[0] = -6;
    EXPECT_THAT(error(), HasSubstr("ebepecnt1: count out of range"));
    counts[0] = 400;
    EXPECT_THAT(error(), HasSubstr("facconn1"));
}

// Of which statistics, block by block, would have no cell.
TEST_F(ExodusIo, BlocksOfBarsAreNoBlocksOfCells) {
    ExodusText text{make_box(1, 1, 1).points, {{"HEX8", 8, {1, 2, 4, 3, 5, 6, 8, 7}}, {"BAR2", 2, {1, 2, 2, 4}}}};
    text.times = {0};
    text.of_elements = {{"stress", {{50}, {-900, 4000}}}};
    const ReadResult result = read_mesh(write("a.exo", exodus_text(text)));
    ASSERT_EQ(result.blocks.size(), 1U);
    EXPECT_EQ(result.blocks[0].name, "block 1");
    ASSERT_EQ(result.fields.size(), 1U);
    EXPECT_EQ(result.fields[0].min, 50);
    EXPECT_EQ(result.fields[0].max, 50);
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
                HasSubstr("no hexahedra, but 1 element of type QUAD"));
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
