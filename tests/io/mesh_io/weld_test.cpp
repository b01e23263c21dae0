// SPDX-License-Identifier: Apache-2.0
// Welding of points and removal of ghost cells when a mesh is read.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/detail/point_welder.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"
#include "subvol/surface.h"
#include "subvol/topology.h"
#include "vtu_texts.h"

namespace subvol::test {

namespace weld_test {

using testing::ElementsAre;
using testing::HasSubstr;

// Two boxes side by side that share no points.
HexMesh two_boxes(double gap) {
    HexMesh mesh = make_box(1, 2, 2), other = make_box(1, 2, 2);
    const auto first = static_cast<Index>(mesh.points.size());
    for (const Vec3& x : other.points) mesh.points.push_back(x + Vec3(1 + gap, 0, 0));
    for (auto cell : other.cells) {
        for (Index& p : cell) p += first;
        mesh.cells.push_back(cell);
    }
    return mesh;
}

class Weld : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const HexMesh& mesh, const ReadOptions& options) const {
        return read_mesh(write("a.mesh", medit_text(mesh)), options);
    }
};

TEST_F(Weld, JoinsPointsAtTheSamePlaceOnly) {
    EXPECT_EQ(inspect(read(two_boxes(0), {}).mesh).boundary_faces, 32u);
    const ReadResult result = read(two_boxes(0), {.weld = 0});
    EXPECT_THAT(result.warnings,
                ElementsAre("9 points welded to others at the same place; the values of the first point are kept"));
    const MeshReport report = inspect(result.mesh), box = inspect(make_box(2, 2, 2));
    EXPECT_EQ(report.points_used, box.points_used);
    EXPECT_EQ(report.faces, box.faces);
    EXPECT_EQ(report.edges, box.edges);
    EXPECT_THAT(read(two_boxes(1e-9), {.weld = 0}).warnings, ElementsAre(HasSubstr("0 points welded")));
}

TEST_F(Weld, JoinsPointsWithinATolerance) {
    for (const double gap : {1e-9, -1e-9, 0.9e-6}) {
        const ReadResult result = read(two_boxes(gap), {.weld = 1e-6});
        EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("9 points welded to others nearby")));
        EXPECT_EQ(inspect(result.mesh).faces, inspect(make_box(2, 2, 2)).faces);
    }
    EXPECT_EQ(inspect(read(two_boxes(1.1e-6), {.weld = 1e-6}).mesh).boundary_faces, 32u);
}

// Where the cubes of a tolerance have numbers so large that adding 1 changes nothing.
TEST_F(Weld, FarAwayPointsAreWelded) {
    HexMesh mesh = two_boxes(0);
    for (Vec3& x : mesh.points) x = x * 1e20 + Vec3(1e22);
    EXPECT_THAT(read(mesh, {.weld = 1e-3}).warnings, ElementsAre(HasSubstr("9 points welded")));
}

TEST_F(Weld, MinusZeroIsZero) {
    HexMesh mesh = two_boxes(0);
    for (std::size_t p = 0; p < mesh.points.size() / 2; ++p) {
        if (mesh.points[p].y == 0) mesh.points[p].y = -0.0;
    }
    EXPECT_THAT(read(mesh, {.weld = 0}).warnings, ElementsAre(HasSubstr("9 points welded")));
}

// A box of cells around x = 0, of which those at x > 0 are halved `levels` times.
HexMesh box_with_hanging_points(int levels) {
    HexMesh mesh = make_box(2, 2, 2);
    std::vector<std::array<Index, 8>> coarse;
    HexMesh fine;
    for (const auto& cell : mesh.cells) {
        double middle = 0;
        for (const Index p : cell) middle += mesh.points[p].x / 8;
        if (middle < 1) coarse.push_back(cell);
    }
    const auto n = static_cast<Index>(1 << levels);
    fine = make_box(n, 2 * n, 2 * n);
    std::vector<Index> number;
    for (const Vec3& x : fine.points) {
        const Vec3 at = Vec3(1, 0, 0) + x / static_cast<double>(n);
        const auto same = std::ranges::find(mesh.points, at);  // the corners of the large cells are those of small ones
        number.push_back(static_cast<Index>(same - mesh.points.begin()));
        if (same == mesh.points.end()) mesh.points.push_back(at);
    }
    mesh.cells = coarse;
    for (auto cell : fine.cells) {
        for (Index& p : cell) p = number[p];
        mesh.cells.push_back(cell);
    }
    return mesh;
}

double area_of(const Surface& surface) {
    double area = 0;
    for (const auto& [a, b, c] : surface.triangles) {
        area += glm::length(glm::cross(surface.points[b] - surface.points[a], surface.points[c] - surface.points[a])) / 2;
    }
    return area;
}

TEST_F(Weld, HangingPointsAreSaidAndTheirCellsSplit) {
    for (const int levels : {1, 2}) {
        const HexMesh mesh = box_with_hanging_points(levels);
        const std::size_t side = (2U << levels) + 1, hanging = side * side - 9;  // but the corners of the large cells
        const ReadResult apart = read(mesh, {});
        if (levels == 1) {
            EXPECT_THAT(apart.warnings, testing::Contains(HasSubstr(std::to_string(hanging) + " points hang in the middle")));
        }
        EXPECT_NEAR(area_of(boundary_surface(apart.mesh)), 24 + 8, 1e-9);
        const ReadResult welded = read(mesh, {.weld = 0});
        EXPECT_THAT(welded.warnings, testing::Contains(HasSubstr("4 cells with hanging points split")));
        const MeshReport report = inspect(welded.mesh);
        EXPECT_NEAR(report.volume, 8, 1e-9);
        EXPECT_EQ(report.inverted_cells, 0u);
        EXPECT_EQ(report.nonmanifold_faces, 0u);
        EXPECT_NEAR(area_of(boundary_surface(welded.mesh)), 24, 1e-9);  // nothing is open inside
    }
    // Cells of any size that fit together have no such points.
    HexMesh graded = make_box(4, 2, 2);
    for (Vec3& x : graded.points) x.x = std::exp(x.x);
    EXPECT_TRUE(read(graded, {}).warnings.empty());
    EXPECT_EQ(read(graded, {.weld = 0}).mesh.cells.size(), 16u);
}

TEST_F(Weld, RefusesToCollapseCells) {
    EXPECT_THAT(error_of([&] { static_cast<void>(read(make_box(2, 2, 2), {.weld = 1})); }),
                HasSubstr("a cell has vertex 1 and vertex 2, which would be welded (a smaller tolerance"));
    for (const double weld : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        EXPECT_THAT(error_of([&] { static_cast<void>(read(make_box(2, 2, 2), {.weld = weld})); }),
                    HasSubstr("points cannot be welded within"));
    }
}

// A row of five cells in two pieces that overlap by one; the second has a hidden cell.
std::string ghost_text(VtuText& vtu) {
    HexMesh left = make_box(3, 1, 1), right = make_box(3, 1, 1);
    for (Vec3& x : right.points) x.x += 2;
    const auto data = [&](const std::vector<std::uint8_t>& ghosts, double value) {
        return "<CellData>" + vtu.array("UInt8", "Name=\"vtkGhostType\"", ghosts) +
               vtu.array("Float64", "Name=\"c\"", std::vector<double>(3, value)) + "</CellData>";
    };
    return vtu.file(vtu.piece(left, data({0, 0, 1}, 1)) + vtu.piece(right, data({0, 0, 32}, 2)));
}

TEST_F(Weld, GhostCellsAreLeftOut) {
    VtuText vtu;
    const ReadResult result = read_mesh(write("a.vtu", ghost_text(vtu)), {.weld = 0});
    EXPECT_THAT(result.warnings, ElementsAre("2 pieces put together", "2 ghost cells (duplicate or hidden) left out",
                                             HasSubstr("4 points welded"), HasSubstr("cell array \"c\"")));
    const MeshReport report = inspect(result.mesh);
    EXPECT_EQ(report.cells, 4u);
    EXPECT_EQ(report.volume, 4);
    EXPECT_EQ(report.faces, inspect(make_box(4, 1, 1)).faces);
    EXPECT_EQ(result.mesh.find_attribute("vtkGhostType"), nullptr);
    ASSERT_EQ(result.fields.size(), 1u);
    const auto& values = result.mesh.find_attribute("c")->values;
    EXPECT_EQ(values[2], 1.5);  // between the pieces
    EXPECT_EQ(values[1], 1);
}

TEST_F(Weld, CellsWithHiddenPointsAreLeftOut) {
    const auto text = [](const std::string& ghosts) {
        return vtk_text(make_box(3, 1, 1)) + "POINT_DATA 16\nSCALARS vtkGhostType unsigned_char 1\nLOOKUP_TABLE default\n" +
               ghosts;
    };
    // Cells keep duplicate points (1); only hidden points (2) count.
    const ReadResult result = read_mesh(write("a.vtk", text("1 1 1 1 1 1 1 2 1 1 1 1 1 1 1 1\n")));
    EXPECT_THAT(result.warnings, ElementsAre("1 cell with hidden points left out"));
    EXPECT_EQ(inspect(result.mesh).volume, 2);
    const std::string all = text("2 2 2 2 2 2 2 2 2 2 2 2 2 2 2 2\n");
    EXPECT_THAT(error_of([&] { static_cast<void>(read_mesh(write("b.vtk", all))); }), HasSubstr("the mesh has no hexahedra"));
}

/// Points by the dozen about places near the sides of the welder's cubes, some of them at the tolerance from each other.
TEST(PointWelder, JoinsWhatEveryPairJoins) {
    for (const double tolerance : {0.0, 1e-9, 0.1}) {
        for (const double far : {0.0, 1e6}) {
            std::mt19937 random(7);
            std::uniform_int_distribution<int> step(-6, 6), cube(-2, 2);
            std::vector<Vec3> points;
            for (int k = 0; k < 1500; ++k) {
                Vec3 x(far);
                for (int axis = 0; axis < 3; ++axis)
                    x[axis] += tolerance > 0 ? tolerance * (4 * cube(random) + step(random) / 4.0) : cube(random);
                points.push_back(x);
            }
            detail::PointWelder welder(points, tolerance);
            std::vector<Index> kept;
            for (Index p = 0; p < points.size(); ++p) {
                const auto first =
                    std::ranges::find_if(kept, [&](Index q) { return glm::distance(points[q], points[p]) <= tolerance; });
                const Index expected = first == kept.end() ? p : *first;
                ASSERT_EQ(welder.join(p), expected) << tolerance << " " << far << " " << p;
                if (expected == p) kept.push_back(p);
            }
        }
    }
}

}  // namespace weld_test

}  // namespace subvol::test
