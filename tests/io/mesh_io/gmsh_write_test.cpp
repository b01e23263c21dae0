// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <map>

#include "io/field_of_roots.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

namespace gmsh_write_test {

using testing::ElementsAre;
using testing::HasSubstr;

class GmshWrite : public TempFolder {
protected:
    ReadResult again(const HexMesh& mesh, const MeshSets& sets = {}) {
        warnings_ = write_mesh(path("a.msh"), mesh, {}, sets);
        return read_mesh(path("a.msh"));
    }

    std::vector<std::string> warnings_;
};

// Cells, sides and points in several groups at once.
TEST_F(GmshWrite, PatchesAndSetsComeBack) {
    const HexMesh box = make_box(3, 2, 1);
    MeshSets sets;
    sets.patches = {
        {"left", {{0, 0}, {3, 0}}}, {"lid of \"it\"", {{0, 5}, {1, 5}, {2, 5}}}, {"all of cell 0", {{0, 0}, {0, 4}, {0, 5}}}};
    sets.sets = {{"a", {0, 1, 2}}, {"b", {2, 3}}, {"nothing", {}}, {"two\nlines", {5}}};
    const std::vector<Index> edge{0, 1, 2, 3}, corner{0};
    sets.nodes = {node_set_of(box, "edge", edge), node_set_of(box, "corner", corner)};
    const ReadResult read = again(box, sets);
    EXPECT_THAT(warnings_, ElementsAre(HasSubstr("is called \"lid of 'it'\""), HasSubstr("is called \"two_lines\"")));
    std::map<std::string, std::vector<std::pair<Index, int>>> patches;
    for (const Patch& patch : read.sets.patches) {
        for (const CellSide& side : patch.sides) patches[patch.name].emplace_back(side.cell, side.side);
        std::ranges::sort(patches[patch.name]);
    }
    EXPECT_THAT(patches["left"], ElementsAre(std::pair(0, 0), std::pair(3, 0)));
    EXPECT_THAT(patches["lid of 'it'"], ElementsAre(std::pair(0, 5), std::pair(1, 5), std::pair(2, 5)));
    EXPECT_THAT(patches["all of cell 0"], ElementsAre(std::pair(0, 0), std::pair(0, 4), std::pair(0, 5)));
    EXPECT_EQ(patches.size(), 3u);
    EXPECT_TRUE(read.warnings.empty()) << read.warnings[0];
    // Cells in no set have a group, too: Gmsh saves elements of groups alone. Elements come by their groups, so cells have
    // another order.
    EXPECT_THAT(read.sets.sets, testing::Contains(testing::Field(&CellSet::name, "cells")));
    std::map<std::string, std::vector<std::array<Index, 8>>> cells;
    for (const CellSet& set : read.sets.sets) {
        for (const Index c : set.cells) cells[set.name].push_back(read.mesh.cells[c]);
        std::ranges::sort(cells[set.name]);
    }
    for (const auto& [name, numbers] : {std::pair<std::string, std::vector<Index>>{"a", {0, 1, 2}}, {"b", {2, 3}}}) {
        std::vector<std::array<Index, 8>> expected;
        for (const Index c : numbers) expected.push_back(box.cells[c]);
        std::ranges::sort(expected);
        EXPECT_EQ(cells[name], expected) << name;
    }
    std::map<std::string, std::vector<Index>> nodes;
    for (const NodeSet& set : read.sets.nodes) nodes[set.name] = points_of(read.mesh, set);
    EXPECT_EQ(nodes["edge"], edge);
    EXPECT_EQ(nodes["corner"], corner);
}

TEST_F(GmshWrite, FieldsComeBackAtTheirCellsAndPoints) {
    HexMesh box = make_box(2, 1, 1);
    box.time = 2.5;
    const std::size_t points = box.points.size();
    const auto field = [&](const char* name, int channels) { return field_of_roots(box, name, channels); };
    box.attributes = {field("T", 1), field("U", 3), field("S", 6), field("odd", 2)};
    Attribute material{"material", 1, std::vector<double>(points, 1)};
    material.cells = {7, 4};
    material.constant = true;
    box.attributes.push_back(material);
    // Cell 1 is the only one of a set, so it comes first or last in the file.
    const ReadResult read = again(box, {{}, {{"one", {1}}}});
    EXPECT_THAT(warnings_, ElementsAre(".msh cannot hold attributes: \"odd\" not written"));
    EXPECT_EQ(read.mesh.points, box.points);
    EXPECT_EQ(read.mesh.find_attribute("T")->values, box.attributes[0].values);
    EXPECT_EQ(read.mesh.find_attribute("U")->values, box.attributes[1].values);
    const Attribute* const tensor = read.mesh.find_attribute("S");
    ASSERT_NE(tensor, nullptr);
    const std::vector<double>& s = box.attributes[2].values;  // xx, yy, zz, xy, yz, xz
    const auto channels = static_cast<std::size_t>(tensor->channels);
    ASSERT_TRUE(channels == 6 || channels == 9);
    for (std::size_t p = 0; p < points; ++p) {
        const double* const given = &s[6 * p];
        const double* const found = &tensor->values[channels * p];
        if (channels == 6) {
            for (std::size_t c = 0; c < 6; ++c) EXPECT_EQ(found[c], given[c]);
        } else {
            const std::array<double, 9> whole{given[0], given[3], given[5], given[3], given[1],
                                              given[4], given[5], given[4], given[2]};
            for (std::size_t c = 0; c < 9; ++c) EXPECT_EQ(found[c], whole[c]);
        }
    }
    const Attribute* const labels = read.mesh.find_attribute("material");
    ASSERT_NE(labels, nullptr);
    ASSERT_EQ(labels->cells.size(), 2u);
    for (std::size_t c = 0; c < 2; ++c) {
        const auto at = std::ranges::find(box.cells, read.mesh.cells[c]) - box.cells.begin();
        EXPECT_EQ(labels->cells[c], material.cells[static_cast<std::size_t>(at)]);
    }
}

}  // namespace gmsh_write_test

}  // namespace subvol::test
