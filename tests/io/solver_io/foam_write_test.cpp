// SPDX-License-Identifier: Apache-2.0
// Cases of OpenFOAM that are written.

#include <gmock/gmock.h>

#include <map>
#include <sstream>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

namespace foam_write_test {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class FoamWrite : public TempFolder {
protected:
    ReadResult again(const HexMesh& mesh, const MeshSets& sets = {}) {
        warnings_ = write_mesh(path("a.foam"), mesh, {}, sets);
        return read_mesh(path("a.foam"), {.cell_values = CellValues::Constant});
    }
    void make(const std::string& name, const std::string& text) const {
        fs::create_directories(path(name).parent_path());
        (void)write(name, text);
    }
    /// The numbers of a list.
    [[nodiscard]] std::vector<std::size_t> labels(const std::string& name) const {
        const std::string text = read_bytes(path("constant/polyMesh/" + name));
        std::istringstream in(text.substr(text.find("(\n") + 2));
        std::vector<std::size_t> found;
        for (std::size_t label = 0; in >> label;) found.push_back(label);
        return found;
    }

    std::vector<std::string> warnings_;
};

std::array<Index, 8> sorted(std::array<Index, 8> corners) {
    std::ranges::sort(corners);
    return corners;
}

/// The points of each side of a patch, sorted.
std::vector<std::vector<Index>> corners_of(const HexMesh& mesh, const Patch& patch) {
    std::vector<std::vector<Index>> found;
    for (const CellSide& side : patch.sides) {
        auto& corners = found.emplace_back();
        for (const std::size_t k : kCellFaces[side.side]) corners.push_back(mesh.cells[side.cell][k]);
        std::ranges::sort(corners);
    }
    std::ranges::sort(found);
    return found;
}

TEST_F(FoamWrite, AMeshComesBackWithWhatACaseHolds) {
    HexMesh box = make_box(3, 2, 1);
    box.points[5].x += 1.0 / 3;
    const std::size_t points = box.points.size();
    box.attributes = {{"material", 1, std::vector<double>(points, 1)},
                      {"U", 3, std::vector<double>(3 * points, 1)},
                      {"S", 6, std::vector<double>(6 * points, 1)},
                      {"at points", 1, std::vector<double>(points, 0.1)},
                      {"odd", 2, std::vector<double>(2 * points, 1)}};
    for (std::size_t a = 0; a < 3; ++a) {
        Attribute& field = box.attributes[a];
        for (int k = 0; k < 6 * field.channels; ++k) field.cells.push_back(std::sqrt(static_cast<double>(k) + 0.1));
        field.constant = true;
    }
    box.creases = {{0, 1}};
    MeshSets sets;
    sets.patches = {{"left", {{0, 0}, {3, 0}}}, {"a lid", {{0, 5}, {4, 5}}}, {"second", {{3, 0}, {5, 5}}}, {"nothing", {}}};
    sets.sets = {{"2nd", {1, 3}}, {"both", {1, 2}}, {"nothing", {}}};
    const std::vector<Index> edge{0, 4, 8};
    sets.nodes = {node_set_of(box, "edge", edge)};
    const ReadResult read = again(box, sets);
    EXPECT_THAT(
        warnings_,
        ElementsAre("patch \"a lid\" is called \"a_lid\"",
                    "1 face of patch \"second\" not written there: a face is in one patch, the first that has it",
                    "set of cells \"2nd\" is called \"S_2nd\"", "field \"at points\" is called \"at_points\"",
                    ".foam cannot hold attributes: \"odd\" not written", "1 crease not written: .foam files do not have them"));
    EXPECT_EQ(read.mesh.points, box.points);
    ASSERT_EQ(read.mesh.cells.size(), box.cells.size());
    for (std::size_t c = 0; c < box.cells.size(); ++c) EXPECT_EQ(sorted(read.mesh.cells[c]), sorted(box.cells[c])) << c;
    std::map<std::string, std::vector<std::vector<Index>>> patches;
    for (const Patch& patch : read.sets.patches) patches[patch.name] = corners_of(read.mesh, patch);
    EXPECT_EQ(patches["left"], corners_of(box, sets.patches[0]));
    EXPECT_EQ(patches["a_lid"], corners_of(box, sets.patches[1]));
    EXPECT_EQ(patches["second"], corners_of(box, {"", {{5, 5}}}));
    EXPECT_EQ(patches["defaultFaces"].size(), 22u - 5);
    ASSERT_EQ(read.sets.sets.size(), 2u);
    EXPECT_THAT(read.sets.sets[0].cells, ElementsAre(1, 3));
    EXPECT_THAT(read.sets.sets[1].cells, ElementsAre(1, 2));
    for (std::size_t a = 0; a < 3; ++a) {
        const Attribute* const found = read.mesh.find_attribute(box.attributes[a].name);
        ASSERT_NE(found, nullptr) << a;
        EXPECT_EQ(found->cells, box.attributes[a].cells) << a;
    }
    EXPECT_THAT(read_bytes(path("0/at_points")), HasSubstr("class       pointScalarField;"));
    EXPECT_THAT(read_bytes(path("constant/polyMesh/pointZones")), HasSubstr("edge\n{\n    type pointZone;"));
    EXPECT_EQ(file_count(), 4u);  // a.foam, 0, constant, system
}

// Of the cells of two faces the smaller numbers rise, and of those of one cell the larger ones.
TEST_F(FoamWrite, FacesInsideAreInTheOrderOfTheirCells) {
    const HexMesh box = make_box(3, 3, 3);
    (void)again(box);
    const std::vector<std::size_t> owner = labels("owner"), neighbour = labels("neighbour");
    ASSERT_EQ(neighbour.size(), 54u);
    ASSERT_EQ(owner.size(), 108u);
    for (std::size_t f = 0; f < neighbour.size(); ++f) {
        EXPECT_LT(owner[f], neighbour[f]);
        if (f > 0) {
            EXPECT_LT(std::pair(owner[f - 1], neighbour[f - 1]), std::pair(owner[f], neighbour[f]));
        }
    }
    EXPECT_THAT(read_bytes(path("constant/polyMesh/owner")), HasSubstr("nPoints:64  nCells:27  nFaces:108  nInternalFaces:54"));
}

TEST_F(FoamWrite, NothingThatIsThereIsReplaced) {
    HexMesh cube = make_box(1, 1, 1);
    cube.attributes = {{"T", 1, std::vector<double>(8, 1)}};
    make("constant/polyMesh/mine", "text");
    const auto refused = [&] { write_mesh(path("a.foam"), cube); };
    EXPECT_THAT(error_of(refused), HasSubstr("constant/polyMesh: there is a mesh of OpenFOAM already, which is not replaced"));
    EXPECT_EQ(read_bytes(path("constant/polyMesh/mine")), "text");
    EXPECT_EQ(file_count(), 1u);
    fs::remove_all(path("constant/polyMesh"));
    make("0/U", "mine");
    make("constant/transportProperties", "mine");
    make("system/controlDict", "mine");
    make("a.foam", "mine");
    const ReadResult read = again(cube);
    EXPECT_THAT(warnings_, ElementsAre("the fields are not written: the folder \"0\" of the case is there already"));
    EXPECT_EQ(read.mesh.points, cube.points);
    for (const char* name : {"0/U", "constant/transportProperties", "system/controlDict", "a.foam"})
        EXPECT_EQ(read_bytes(path(name)), "mine") << name;
    EXPECT_EQ(file_count(), 4u);
}

TEST_F(FoamWrite, AFailureLeavesNothing) {
    HexMesh cube = make_box(1, 1, 1);
    cube.attributes = {{"T", 1, std::vector<double>(8, 1)}};
    EXPECT_THAT(error_of([&] { write_mesh(path("none/a.foam"), cube); }, ErrorCode::Io), HasSubstr("does not exist"));
    EXPECT_EQ(file_count(), 0u);
    (void)write("constant", "a file in the way of the folder");
    EXPECT_THAT(error_of([&] { write_mesh(path("a.foam"), cube); }, ErrorCode::Io), HasSubstr("a.foam: cannot be written"));
    EXPECT_EQ(file_count(), 1u);
}

}  // namespace foam_write_test

}  // namespace subvol::test
