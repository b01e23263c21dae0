// SPDX-License-Identifier: Apache-2.0
// Exodus II that is written, beside what its manual says.

#include <gmock/gmock.h>

#include <map>

#include "exodus/classic_netcdf.h"
#include "io/field_of_roots.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/detail/netcdf_source.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_series.h"

namespace subvol::test {

namespace exodus_write_test {

using testing::ElementsAre;
using testing::HasSubstr;

class ExodusWrite : public TempFolder {
protected:
    ReadResult again(const HexMesh& mesh, const MeshSets& sets = {}) {
        warnings_ = write_mesh(path("a.e"), mesh, {}, sets);
        return read_mesh(path("a.e"));
    }
    [[nodiscard]] std::vector<std::int64_t> integers(const std::string& variable) const {
        const std::string bytes = read_bytes(path("a.e"));
        const auto file = detail::open_classic_netcdf(bytes, "a.e");
        return detail::integers_from(file->values(variable, {}), detail::NumberType::Int32, std::endian::native);
    }

    std::vector<std::string> warnings_;
};

std::map<std::string, std::vector<Index>> cells_by_name(const MeshSets& sets) {
    std::map<std::string, std::vector<Index>> found;
    for (const CellSet& set : sets.sets) found[set.name] = set.cells;
    return found;
}

// Side 1 has the nodes 1, 2, 6, 5, side 2 has 2, 3, 7, 6, side 3 has 3, 4, 8, 7, side 4 has 1, 5, 8, 4, side 5 has 1, 4, 3, 2,
// side 6 has 5, 6, 7, 8.
TEST_F(ExodusWrite, SidesHaveTheNumbersOfTheManual) {
    const HexMesh cube = make_box(1, 1, 1);
    const std::array<std::int64_t, 6> sides{4, 2, 1, 3, 5, 6};  // at x, y and z of 0 and 1
    for (std::size_t side = 0; side < 6; ++side) {
        const ReadResult read = again(cube, {{{"one", {{0, static_cast<std::uint8_t>(side)}}}}, {}});
        EXPECT_THAT(integers("elem_ss1"), ElementsAre(1));
        EXPECT_THAT(integers("side_ss1"), ElementsAre(sides[side]));
        ASSERT_EQ(read.sets.patches.size(), 1u);
        EXPECT_EQ(read.sets.patches[0].name, "one");
        EXPECT_EQ(read.sets.patches[0].sides[0].side, side);
    }
}

TEST_F(ExodusWrite, AMeshComesBackWithAllThatItHas) {
    HexMesh box = make_box(3, 2, 1);
    box.points[5].x += 1.0 / 3;
    box.time = 2.5;
    const std::size_t points = box.points.size();
    const auto field = [&](const char* name, int channels) { return field_of_roots(box, name, channels); };
    box.attributes = {field("T", 1), field("U", 3), field("S", 6), field("G", 9)};
    Attribute material{"material", 1, std::vector<double>(points, 1)};
    material.cells = {7, 4, 3.5, 2, 1, 0};
    material.constant = true;
    box.attributes.push_back(material);
    MeshSets sets;
    sets.patches = {{"left", {{0, 0}, {3, 0}}}, {"a lid of \"it\"", {{0, 5}, {4, 5}, {5, 5}}}, {"nothing", {}}};
    sets.sets = {{"left half", {0, 1, 3}}, {"right half", {2, 4, 5}}, {"nothing", {}}};
    const std::vector<Index> edge{0, 4, 8};
    sets.nodes = {node_set_of(box, "edge", edge), {"nothing", {}}};
    const ReadResult read = again(box, sets);
    EXPECT_TRUE(warnings_.empty()) << warnings_[0];
    EXPECT_THAT(open_series(path("a.e")).times, ElementsAre(2.5));
    // Cells are in the order of the blocks, and their numbers in the mesh are kept.
    const std::vector<std::size_t> order{0, 1, 3, 2, 4, 5};
    EXPECT_THAT(integers("elem_num_map"), ElementsAre(1, 2, 4, 3, 5, 6));
    EXPECT_EQ(read.mesh.points, box.points);
    ASSERT_EQ(read.mesh.cells.size(), order.size());
    for (std::size_t c = 0; c < order.size(); ++c) EXPECT_EQ(read.mesh.cells[c], box.cells[order[c]]) << c;
    const std::map<std::string, std::vector<Index>> expected{{"left half", {0, 1, 2}}, {"right half", {3, 4, 5}}};
    EXPECT_EQ(cells_by_name(read.sets), expected);
    ASSERT_EQ(read.sets.patches.size(), 2u);
    EXPECT_THAT(read.sets.patches[0].sides, ElementsAre(CellSide{0, 0}, CellSide{2, 0}));
    EXPECT_EQ(read.sets.patches[1].name, "a lid of \"it\"");
    EXPECT_THAT(read.sets.patches[1].sides, ElementsAre(CellSide{0, 5}, CellSide{4, 5}, CellSide{5, 5}));
    ASSERT_EQ(read.sets.nodes.size(), 1u);
    EXPECT_EQ(points_of(read.mesh, read.sets.nodes[0]), edge);
    for (const Attribute& given : box.attributes) {
        const Attribute* const found = read.mesh.find_attribute(given.name);
        ASSERT_NE(found, nullptr) << given.name;
        EXPECT_EQ(found->channels, given.channels) << given.name;
        if (given.cells.empty()) {
            EXPECT_EQ(found->values, given.values) << given.name;
        }
    }
    EXPECT_THAT(read.mesh.find_attribute("material")->cells, ElementsAre(7, 4, 2, 3.5, 1, 0));
}

TEST_F(ExodusWrite, AFileIsWrittenAgainAsItWas) {
    const HexMesh box = make_box(4, 1, 1);
    // Each cell is in one block: the set of all comes first, and the cells of no set have a block, too.
    for (const auto& sets : {std::vector<CellSet>{{"a", {1}}, {"b", {1, 2}}, {"cells", {3}}},
                             std::vector<CellSet>{{"all", {0, 1, 2, 3}}, {"b", {1, 2}}}, std::vector<CellSet>{}}) {
        const ReadResult once = again(box, {{}, sets});
        const std::string bytes = read_bytes(path("a.e"));
        const ReadResult twice = again(once.mesh, once.sets);
        EXPECT_EQ(twice.mesh.cells, once.mesh.cells);
        EXPECT_EQ(cells_by_name(twice.sets), cells_by_name(once.sets));
        if (sets.size() == 2) {
            EXPECT_EQ(once.mesh.cells, box.cells);
            EXPECT_EQ(read_bytes(path("a.e")), bytes);
        }
        if (sets.size() == 3) {
            const std::map<std::string, std::vector<Index>> expected{
                {"a", {0}}, {"b", {0, 3}}, {"cells", {1}}, {"cells_", {2, 3}}};
            EXPECT_EQ(cells_by_name(once.sets), expected);
        }
    }
}

TEST_F(ExodusWrite, NamesMayBeLongAndAreDifferent) {
    HexMesh cube = make_box(1, 1, 1);
    const std::string name(100, 'n');
    cube.attributes = {{name, 1, std::vector<double>(8, 1)},
                       {"U_x", 1, std::vector<double>(8, 2)},
                       {"U", 2, std::vector<double>(16, 3)},
                       {"odd", 4, std::vector<double>(32, 4)}};
    cube.creases = {{0, 1}};
    const ReadResult read = again(cube, {{{name, {{0, 1}}}}, {{name + "s", {0}}}});
    EXPECT_THAT(warnings_, ElementsAre("\"U_x\" is called \"U_x_\"", "1 crease not written: .e files do not have them"));
    EXPECT_EQ(read.sets.patches.at(0).name, name);
    EXPECT_EQ(read.sets.sets.at(0).name, name + "s");
    for (const auto& [scalar, value] :
         std::map<std::string, double>{{name, 1}, {"U_x", 2}, {"U_x_", 3}, {"U_y", 3}, {"odd_4", 4}}) {
        ASSERT_NE(read.mesh.find_attribute(scalar), nullptr) << scalar;
        EXPECT_EQ(read.mesh.find_attribute(scalar)->values, std::vector<double>(8, value)) << scalar;
    }
}

// A file whose variables are longer than 64-bit offsets allow has another version.
TEST_F(ExodusWrite, LongVariablesNeedWideNumbers) {
    using Kind = detail::ClassicNetcdfFile::Kind;
    for (const std::uint64_t most : {std::uint64_t{24}, std::uint64_t{23}}) {
        detail::ClassicNetcdfFile file;
        const std::size_t time = file.dimension("time", 0), three = file.dimension("three", 3);
        file.attribute("title", "an odd one");
        file.attribute("size", 8);
        file.variable("steps", Kind::Reals, {time, three}, [](detail::NetcdfValues& to) {
            for (const double value : {0.25, -1e300, 3.0}) to.put(value);
        });
        file.variable("time", Kind::Reals, {time}, [](detail::NetcdfValues& to) { to.put(0.5); });
        file.variable("text", Kind::Characters, {three}, [](detail::NetcdfValues& to) { to.put("ab", 3); }, {{"name", "ID"}});
        file.variable("numbers", Kind::Integers, {three}, [](detail::NetcdfValues& to) {
            for (const std::int32_t value : {-1, 2, 1 << 30}) to.put(value);
        });
        detail::OutputFile out(path("a.e"));
        file.write(out, most);
        out.commit();
        const std::string bytes = read_bytes(path("a.e"));
        EXPECT_EQ(bytes[3], most == 24 ? 2 : 5);
        const auto read = detail::open_classic_netcdf(bytes, "a.e");
        EXPECT_EQ(read->dimensions["three"], 3u);
        EXPECT_EQ(read->dimensions["time"], 1u);
        EXPECT_THAT(integers("numbers"), ElementsAre(-1, 2, 1 << 30));
        EXPECT_EQ(read->attribute("text", "name"), "ID");
        EXPECT_EQ(read->values("text", {}), std::string("ab\0", 3));
        const std::vector<std::size_t> first{0};
        EXPECT_THAT(detail::reals_from(read->values("steps", first), detail::NumberType::Float64, std::endian::native),
                    ElementsAre(0.25, -1e300, 3));
        EXPECT_THAT(detail::reals_from(read->values("time", first), detail::NumberType::Float64, std::endian::native),
                    ElementsAre(0.5));
    }
}

TEST_F(ExodusWrite, AMissingFolderIsSaid) {
    const HexMesh cube = make_box(1, 1, 1);
    EXPECT_THAT(error_of([&] { write_mesh(path("none/a.e"), cube); }, ErrorCode::Io), HasSubstr("does not exist"));
    EXPECT_EQ(file_count(), 0u);
    for (const char* name : {"a.e", "a.exo", "a.ex2", "a.g"}) {
        write_mesh(path(name), cube);
        EXPECT_EQ(read_mesh(path(name)).mesh.points, cube.points) << name;
    }
}

}  // namespace exodus_write_test

}  // namespace subvol::test
