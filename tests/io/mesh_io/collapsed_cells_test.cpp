// SPDX-License-Identifier: Apache-2.0
// Cells that repeat points.

#include <gmock/gmock.h>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "mesh_texts.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::test {

namespace collapsed_cells_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class CollapsedCells : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const HexMesh& mesh, const ReadOptions& options = {}) const {
        return read_mesh(write("a.mesh", medit_text(mesh)), options);
    }

    // The unit cube in the order of a cell, each corner at the place of another one.
    [[nodiscard]] ReadResult read_cube(const std::array<Index, 8>& corners) const {
        HexMesh mesh;
        mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
        mesh.cells = {corners};
        return read(mesh);
    }
};

TEST_F(CollapsedCells, AreWhatTheyLookLike) {
    struct Case {
        std::array<Index, 8> corners;
        std::string kind;
        double volume;
    };
    const std::vector<Case> cases{
        {{0, 1, 2, 2, 4, 5, 6, 6}, "1 prism", 1 / 2.},
        {{0, 1, 2, 3, 0, 1, 6, 7}, "1 prism", 1 / 2.},
        {{0, 0, 2, 3, 4, 4, 6, 7}, "1 prism", 1 / 2.},
        {{0, 1, 2, 3, 4, 4, 4, 4}, "1 pyramid", 1 / 3.},
        {{3, 1, 2, 3, 3, 5, 6, 3}, "1 pyramid", 1 / 3.},
        {{0, 1, 2, 2, 4, 4, 4, 4}, "1 tetrahedron", 1 / 6.},
        {{0, 1, 3, 3, 4, 4, 4, 4}, "1 tetrahedron", 1 / 6.},
        // The face of 1, 2, 7 and 5 is bent along the diagonal from its smallest point.
        {{0, 1, 2, 3, 4, 5, 7, 7}, "4 tetrahedra", 2 / 3.},
    };
    for (const Case& one : cases) {
        const ReadResult result = read_cube(one.corners);
        EXPECT_THAT(result.warnings, Contains("1 cell with repeated points taken as " + one.kind));
        const MeshReport report = inspect(result.mesh);
        EXPECT_NEAR(report.volume, one.volume, 1e-15) << one.kind;
        EXPECT_EQ(report.inverted_cells, 0u) << one.kind;
    }
}

// The second cell of a row loses an edge to its neighbour's face: both still fill the box, with no gap between them.
TEST_F(CollapsedCells, FitToTheirNeighbours) {
    HexMesh mesh = make_box(2, 1, 1);
    const Index lost = mesh.cells[0][6], kept = mesh.cells[0][7];
    for (auto& cell : mesh.cells) std::replace(cell.begin(), cell.end(), lost, kept);
    const MeshReport report = inspect(read(mesh).mesh);
    EXPECT_NEAR(report.volume, 2, 1e-14);
    EXPECT_EQ(report.inverted_cells, 0u);
}

TEST_F(CollapsedCells, AreLeftOutWithoutVolume) {
    HexMesh mesh = make_box(3, 1, 1);
    const auto cell = mesh.cells[1];
    mesh.cells[1] = {cell[0], cell[1], cell[2], cell[3], cell[0], cell[1], cell[2], cell[3]};
    const ReadResult result =
        read_mesh(write("a.vtk", vtk_text(mesh) + "CELL_DATA 3\nSCALARS c double 1\nLOOKUP_TABLE default\n1 2 3\n"));
    EXPECT_THAT(result.warnings, Contains("1 cell without volume (too few different points) left out"));
    EXPECT_EQ(result.mesh.cells.size(), 2u);
    const auto& values = result.mesh.find_attribute("c")->values;
    EXPECT_EQ(values[mesh.cells[0][0]], 1);
    EXPECT_EQ(values[mesh.cells[2][6]], 3);
    mesh.cells = {mesh.cells[1]};
    EXPECT_THAT(error_of([&] { static_cast<void>(read(mesh)); }), HasSubstr("the mesh has no hexahedra"));
}

TEST_F(CollapsedCells, KeepTheValuesOfTheirCell) {
    HexMesh mesh = make_box(2, 1, 1);
    auto& cell = mesh.cells[1];
    cell[2] = cell[1];
    cell[6] = cell[5];
    const ReadResult result =
        read_mesh(write("a.vtk", vtk_text(mesh) + "CELL_DATA 2\nSCALARS c double 1\nLOOKUP_TABLE default\n5 9\n"));
    EXPECT_EQ(result.mesh.cells.size(), 14u);
    const auto& values = result.mesh.find_attribute("c")->values;
    EXPECT_EQ(*std::ranges::max_element(values), 9);
    EXPECT_EQ(*std::ranges::min_element(values), 5);
}

TEST_F(CollapsedCells, AreOtherCellsToTheOptions) {
    HexMesh mesh = make_box(2, 1, 1);
    mesh.cells[1][2] = mesh.cells[1][1];
    mesh.cells[1][6] = mesh.cells[1][5];
    const ReadResult ignored = read(mesh, {.other_cells = OtherCells::Ignore});
    EXPECT_THAT(ignored.warnings, ElementsAre("1 cell with repeated points ignored"));
    EXPECT_EQ(inspect(ignored.mesh).volume, 1);
    EXPECT_THAT(error_of([&] { static_cast<void>(read(mesh, {.other_cells = OtherCells::Refuse})); }),
                HasSubstr("the mesh has 1 hexahedron and 1 prism"));
}

TEST_F(CollapsedCells, RepeatPointsOnlyAlongEdges) {
    EXPECT_THAT(error_of([&] {
                    static_cast<void>(read_cube({0, 1, 0, 3, 4, 5, 6, 7}));
                }),
                HasSubstr("hex 1 has vertex 1 twice, at corners that no collapsed edge joins"));
}

TEST_F(CollapsedCells, HiddenOnesAreNotJudged) {
    HexMesh mesh = make_box(2, 1, 1);
    mesh.cells[1][2] = mesh.cells[1][0];
    const std::string ghosts = "CELL_DATA 2\nSCALARS vtkGhostType unsigned_char 1\nLOOKUP_TABLE default\n0 32\n";
    EXPECT_EQ(inspect(read_mesh(write("a.vtk", vtk_text(mesh) + ghosts)).mesh).volume, 1);
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(write("a.vtk", vtk_text(mesh)))); }),
                HasSubstr("cell 1 has point 1 twice"));
}

// The corners on the axis of a quarter of a pie are different points at the same place.
TEST_F(CollapsedCells, WeldingMakesThemAtAnAxis) {
    HexMesh mesh = make_box(1, 4, 1);
    for (Vec3& x : mesh.points) x = {x.x * std::cos(x.y), x.x * std::sin(x.y), x.z};
    const ReadResult result = read(mesh, {.weld = 0});
    EXPECT_THAT(result.warnings, Contains("4 cells with repeated points taken as 4 prisms"));
    EXPECT_NEAR(inspect(result.mesh).volume, 4 * std::sin(1.) / 2, 1e-12);
}

// VTK's wedges, pyramids and tetrahedra may repeat points too.
TEST_F(CollapsedCells, OfOtherKinds) {
    const std::string points =
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n"
        "0 0 0 1 0 0 0 1 0 0 0 1 1 0 1 0 1 1\n";
    const auto read_cells = [&](const std::string& cells) { return read_mesh(write("b.vtk", points + cells)); };
    const ReadResult wedge = read_cells("CELLS 2 12\n6 0 1 2 3 4 4 4 1 2 0 1\nCELL_TYPES 2\n13 10\n");
    EXPECT_THAT(wedge.warnings, Contains("1 cell without volume (too few different points) left out"));
    EXPECT_THAT(wedge.warnings, Contains(HasSubstr("1 cell with repeated points taken as")));
    const ReadResult pyramid = read_cells("CELLS 1 6\n5 0 1 2 2 3\nCELL_TYPES 1\n14\n");
    EXPECT_THAT(pyramid.warnings, Contains("1 cell with repeated points taken as 1 tetrahedron"));
    EXPECT_NEAR(inspect(pyramid.mesh).volume, 1 / 6., 1e-15);
    const ReadResult standing = read_cells("CELLS 1 7\n6 0 1 2 3 4 2\nCELL_TYPES 1\n13\n");
    EXPECT_NEAR(inspect(standing.mesh).volume, 1 / 3., 1e-15);
}

}  // namespace collapsed_cells_test

}  // namespace subvol::test
