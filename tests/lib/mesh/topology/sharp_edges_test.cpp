// SPDX-License-Identifier: Apache-2.0
#include "subvol/sharp_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/detail/facets.h"
#include "subvol/topology.h"

namespace subvol {
namespace sharp_edges_test {

/// Columns of cells over nodes (x, y) of a plane, two layers high. quads: counter-clockwise
HexMesh extruded(const std::vector<std::array<double, 2>>& nodes, const std::vector<std::array<Index, 4>>& quads) {
    HexMesh mesh;
    const auto count = static_cast<Index>(nodes.size());
    for (int z = 0; z < 3; ++z) {
        for (const auto& [x, y] : nodes) mesh.points.emplace_back(x, y, z);
    }
    for (Index layer = 0; layer < 2; ++layer) {
        for (const auto& q : quads) {
            std::array<Index, 8> cell{};
            for (std::size_t k = 0; k < 4; ++k) {
                cell[k] = q[k] + layer * count;
                cell[k + 4] = q[k] + (layer + 1) * count;
            }
            mesh.cells.push_back(cell);
        }
    }
    return mesh;
}

/// A ring of cells with so many sides, whose corners lie on circles.
HexMesh ring(Index sides) {
    std::vector<std::array<double, 2>> nodes;
    std::vector<std::array<Index, 4>> quads;
    for (Index k = 0; k < sides; ++k) {
        const double angle = 2 * std::numbers::pi * k / static_cast<double>(sides);
        for (const double radius : {1., 2.}) nodes.push_back({radius * std::cos(angle), radius * std::sin(angle)});
        const Index next = (k + 1) % sides;
        quads.push_back({2 * k, 2 * k + 1, 2 * next + 1, 2 * next});
    }
    return extruded(nodes, quads);
}

/// A strip of cells from the ground to a line of heights at x = 0, 1, 2 …
HexMesh under(const std::vector<double>& heights) {
    std::vector<std::array<double, 2>> nodes;
    std::vector<std::array<Index, 4>> quads;
    for (Index k = 0; k < heights.size(); ++k) {
        nodes.push_back({static_cast<double>(k), 0});
        nodes.push_back({static_cast<double>(k), heights[k]});
        if (k > 0) quads.push_back({2 * k - 2, 2 * k, 2 * k + 1, 2 * k - 1});
    }
    return extruded(nodes, quads);
}

std::size_t sharp_in(HexMesh mesh) {
    return keep_sharp_edges(mesh).edges;
}

TEST(SharpEdges, TheReentrantEdgesOfACornerCutOutAreSharp) {
    HexMesh fichera = test::make_box(2, 2, 2);
    fichera.cells.pop_back();  // at the corner (2, 2, 2)
    EXPECT_EQ(keep_sharp_edges(fichera).edges, 3u);
    for (const auto& [a, b] : fichera.creases) {
        for (const Index p : {a, b}) {  // from the middle of the box outward along the axes
            int beyond = 0;
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_GE(fichera.points[p][axis], 1);
                beyond += fichera.points[p][axis] > 1;
            }
            EXPECT_LE(beyond, 1);
        }
    }
    EXPECT_NO_THROW(std::ignore = build_topology(fichera));  // they are edges of the boundary
    EXPECT_EQ(keep_sharp_edges(fichera).edges, 0u);          // each once
}

TEST(SharpEdges, EdgesOfASingleCellNeedNoTag) {
    EXPECT_EQ(sharp_in(test::make_box(3, 2, 4)), 0u);
}

TEST(SharpEdges, FewCellsAroundMakeARoundHole) {
    for (const Index sides : {6U, 7U, 8U, 9U, 12U}) EXPECT_EQ(sharp_in(ring(sides)), 0u) << sides;
    // Five sides bend by 72 degrees: at the edges inside and outside, in two layers.
    EXPECT_EQ(sharp_in(ring(5)), 20u);
    EXPECT_EQ(sharp_in(ring(4)), 16u);
}

TEST(SharpEdges, AChamferIsSharp) {
    EXPECT_EQ(sharp_in(under({2, 2, 2, 1, 1, 1})), 4u);  // two edges of 45 degrees, one of them re-entrant
    EXPECT_EQ(sharp_in(under({3, 3, 2, 2})), 4u);
    EXPECT_EQ(sharp_in(under({3, 3, 2})), 2u);
    // A ramp of 39 degrees is none.
    EXPECT_EQ(sharp_in(under({3, 3, 3 - std::tan(39 * std::numbers::pi / 180)})), 0u);
    // A ridge: the next bends, at the eaves, are those of edges.
    EXPECT_EQ(sharp_in(under({2, 2.5, 2})), 2u);
}

TEST(SharpEdges, BoxOfTriangles) {
    const HexMesh box = test::make_box(2, 2, 2);
    MixedCells cells;
    for (const auto& cell : box.cells) {
        for (const auto& tet : split_cell(cell)) cells.tets.push_back(tet);
    }
    const auto found = detail::find_sharp_edges(box.points, {}, cells);
    const auto on_edge = [&](const std::array<Index, 2>& edge) {  // of the box
        const Vec3 middle = .5 * (box.points[edge[0]] + box.points[edge[1]]);
        int sides = 0;
        for (int axis = 0; axis < 3; ++axis) sides += middle[axis] == 0 || middle[axis] == 2;
        return sides == 2;
    };
    EXPECT_TRUE(std::ranges::all_of(found.edges, on_edge));
    EXPECT_GT(found.edges.size(), 0u);
    EXPECT_LE(found.edges.size(), 24u);
    // Left-handed tetrahedra have the same boundary.
    for (auto& tet : cells.tets) std::swap(tet[2], tet[3]);
    EXPECT_EQ(detail::find_sharp_edges(box.points, {}, cells).edges, found.edges);
}

/// A cube of n³ cells whose boundary lies on a sphere.
HexMesh coarse_ball(Index n) {
    HexMesh mesh = test::make_box(n, n, n);
    for (Vec3& p : mesh.points) {
        p = p * (2.0 / n) - Vec3(1.0);
        const double cube = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        if (cube > 0) p *= cube / glm::length(p);
    }
    return mesh;
}

TEST(SharpEdges, ACoarseBallIsRound) {
    for (const Index n : {2U, 3U, 4U}) {
        const HexMesh ball = coarse_ball(n);
        EXPECT_EQ(sharp_in(ball), 0u) << n;
        MixedCells tets;
        for (const auto& cell : ball.cells) {
            for (const auto& tet : split_cell(cell)) tets.tets.push_back(tet);
        }
        EXPECT_EQ(detail::find_sharp_edges(ball.points, {}, tets).edges.size(), 0u) << n;
    }
}

TEST(SharpEdges, StepsAreToldFromOtherEdges) {
    HexMesh voxels = test::make_box(6, 6, 6);
    std::erase_if(voxels.cells, [&](const auto& cell) {
        return glm::distance(.5 * (voxels.points[cell[0]] + voxels.points[cell[6]]), Vec3(3.0)) > 2.8;
    });
    EXPECT_TRUE(keep_sharp_edges(voxels).steps);
    HexMesh fichera = test::make_box(2, 2, 2), chamfer = under({3, 3, 2, 2});
    fichera.cells.pop_back();
    EXPECT_FALSE(keep_sharp_edges(fichera).steps);
    EXPECT_FALSE(keep_sharp_edges(chamfer).steps);
}

/// A square of one cell in a ring of four more whose outer corners lie around it, in two layers.
HexMesh square_in_square() {
    return extruded({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-3, -3}, {3, -3}, {3, 3}, {-3, 3}},
                    {{0, 1, 2, 3}, {4, 5, 1, 0}, {5, 6, 2, 1}, {6, 7, 3, 2}, {7, 4, 0, 3}});
}

TEST(SharpEdges, AnInterfaceBetweenPartsIsSharpAsAWhole) {
    const HexMesh mesh = square_in_square();
    std::vector<Index> parts(mesh.cells.size(), 0);
    parts[0] = parts[5] = 1;  // the square
    const auto found = detail::find_sharp_edges(mesh.points, mesh.cells, {}, parts);
    EXPECT_EQ(found.faces_between.size(), 8u);
    EXPECT_EQ(found.edges_between.size(), 8u);  // its four edges, where three cells meet
    HexMesh tagged = mesh;
    tagged.sharp_faces = found.faces_between;
    tagged.creases = found.edges_between;
    EXPECT_NO_THROW(std::ignore = build_topology(tagged));
    // A flat interface, and the corner of a part in a grid, which the limit keeps.
    const HexMesh box = test::make_box(4, 4, 2);
    std::vector<Index> half, corner;
    for (const auto& cell : box.cells) {
        const Vec3 middle = .5 * (box.points[cell[0]] + box.points[cell[6]]);
        half.push_back(middle.x < 2);
        corner.push_back(middle.x < 2 && middle.y < 2);
    }
    EXPECT_TRUE(detail::find_sharp_edges(box.points, box.cells, {}, half).faces_between.empty());
    EXPECT_TRUE(detail::find_sharp_edges(box.points, box.cells, {}, corner).faces_between.empty());
}

TEST(SharpEdges, DoNotDependOnTheOrderAndTheHandOfCells) {
    HexMesh one = ring(5), other = one;
    std::ranges::reverse(other.cells);
    for (auto& cell : other.cells) {
        for (std::size_t k = 0; k < 4; ++k) std::swap(cell[k], cell[k + 4]);  // left-handed
    }
    keep_sharp_edges(one);
    keep_sharp_edges(other);
    EXPECT_EQ(one.creases, other.creases);
}

}  // namespace sharp_edges_test
}  // namespace subvol
