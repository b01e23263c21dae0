// SPDX-License-Identifier: Apache-2.0
#include "subvol/mixed_cells.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/mesh_report.h"
#include "subvol/topology.h"

namespace subvol::test {

namespace mixed_cells_test {

constexpr double kRounding = 1e-13;  // sums of some hundred exact terms of order one

struct Mixed {
    HexMesh hexes;
    MixedCells others;
};

// A unit cube, a prism against its face x = 1, a pyramid on its face z = 1, a tetrahedron on the pyramid's side.
Mixed row_of_kinds() {
    Mixed mixed;
    mixed.hexes = make_box(1, 1, 1);  // points i + 2j + 4k
    mixed.hexes.points.emplace_back(2, 0, 0);
    mixed.hexes.points.emplace_back(2, 1, 0);
    mixed.hexes.points.emplace_back(0.5, 0.5, 2);
    mixed.hexes.points.emplace_back(2, 0.5, 2);
    mixed.others.prisms = {{1, 8, 5, 3, 9, 7}};
    mixed.others.pyramids = {{4, 5, 7, 6, 10}};
    mixed.others.tets = {{5, 7, 10, 11}};
    return mixed;
}

// Every box cell cut into its six tetrahedra.
Mixed box_of_tets(Index n) {
    Mixed mixed;
    const HexMesh box = make_box(n, n, n);
    mixed.hexes.points = box.points;
    for (const auto& cell : box.cells) {
        const auto tets = split_cell(cell);
        mixed.others.tets.insert(mixed.others.tets.end(), tets.begin(), tets.end());
    }
    return mixed;
}

// Every box cell cut into two prisms by the diagonal 0-2.
Mixed box_of_prisms(Index n) {
    Mixed mixed;
    const HexMesh box = make_box(n, n, n);
    mixed.hexes.points = box.points;
    for (const auto& c : box.cells) {
        mixed.others.prisms.push_back({c[0], c[1], c[2], c[4], c[5], c[6]});
        mixed.others.prisms.push_back({c[0], c[2], c[3], c[4], c[6], c[7]});
    }
    return mixed;
}

// Every other box cell, as on a chessboard, replaced by six pyramids about its centre.
Mixed chessboard_of_pyramids(Index n) {
    Mixed mixed;
    mixed.hexes = make_box(n, n, n);
    const auto cells = std::move(mixed.hexes.cells);
    mixed.hexes.cells.clear();
    for (const auto& cell : cells) {
        const Vec3 low = mixed.hexes.points[cell[0]];
        if (std::lround(low.x + low.y + low.z) % 2 == 0) {
            mixed.hexes.cells.push_back(cell);
            continue;
        }
        const auto centre = static_cast<Index>(mixed.hexes.points.size());
        mixed.hexes.points.push_back(low + Vec3(0.5));
        for (const auto& face : kCellFaces) {
            const auto corner = [&](std::size_t k) { return cell[static_cast<std::size_t>(face[k])]; };
            mixed.others.pyramids.push_back({corner(0), corner(1), corner(2), corner(3), centre});
        }
    }
    return mixed;
}

MeshReport report_of(const Mixed& mixed) {
    return inspect(split_into_hexes(mixed.hexes, mixed.others));
}

TEST(MixedCells, AHexBecomesEight) {
    const MeshReport report = report_of({make_box(2, 1, 1), {}});
    EXPECT_EQ(report.points, 12u + 20 + 11 + 2);  // points, edges, faces, cells
    EXPECT_EQ(report.cells, 16u);
    EXPECT_NEAR(report.min_scaled_jacobian, 1, kRounding);
}

TEST(MixedCells, ARegularTetrahedronHasChildrenOfKnownShape) {
    const Mixed tet{only_points({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}), {{{0, 1, 2, 3}}, {}, {}}};
    const MeshReport report = report_of(tet);
    EXPECT_EQ(report.points, 4u + 6 + 4 + 1);
    EXPECT_EQ(report.cells, 4u);
    EXPECT_EQ(report.boundary_faces, 12u);
    EXPECT_NEAR(report.volume, 8.0 / 3, kRounding);
    // The worst corner has three edges at 60 degrees to each other: the square root of 1 + 2/8 - 3/4.
    EXPECT_NEAR(report.min_scaled_jacobian, std::sqrt(0.5), kRounding);
}

TEST(MixedCells, APrismBecomesSix) {
    const Mixed prism{only_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}, {1, 0, 2}, {0, 1, 2}}),
                      {{}, {{0, 1, 2, 3, 4, 5}}, {}}};
    const MeshReport report = report_of(prism);
    EXPECT_EQ(report.points, 6u + 9 + 5 + 1);
    EXPECT_EQ(report.cells, 6u);
    EXPECT_EQ(report.boundary_faces, 2u * 3 + 3 * 4);
    EXPECT_EQ(report.inverted_cells, 0u);
    EXPECT_NEAR(report.volume, 1, kRounding);
}

TEST(MixedCells, PyramidsTurnAllIntoTetrahedraFirst) {
    const Mixed mixed = row_of_kinds();
    const HexMesh split = split_into_hexes(mixed.hexes, mixed.others);
    const MeshReport report = inspect(split);
    EXPECT_EQ(report.cells, 4u * (6 + 3 + 2 + 1));
    EXPECT_EQ(report.inverted_cells, 0u);
    // The outer faces: cube 4 quads, prism 2 triangles and 2 quads, pyramid 3 triangles, tetrahedron 3. A quad is cut into two
    // triangles, and each triangle becomes three quads.
    EXPECT_EQ(report.boundary_faces, 3u * (4 * 2 + 2 + 2 * 2 + 3 + 3));
}

TEST(MixedCells, VolumeIsKeptAndNeighboursFit) {
    constexpr std::size_t n = 3;
    // A square of the hull becomes 4 quads, or 2 triangles of 3 quads each. If two cells did not fit together there would be
    // more.
    const std::vector<std::pair<Mixed, std::size_t>> cases{{box_of_tets(n), 6 * n * n * 6},
                                                           {box_of_prisms(n), 2 * n * n * 6 + 4 * n * n * 4},
                                                           {chessboard_of_pyramids(n), 6 * n * n * 6}};
    for (const auto& [mixed, boundary_faces] : cases) {
        const MeshReport report = report_of(mixed);
        EXPECT_NEAR(report.volume, n * n * n, n * n * n * kRounding);
        EXPECT_EQ(report.inverted_cells, 0u);
        EXPECT_EQ(report.nonmanifold_edges, 0u);
        EXPECT_EQ(report.boundary_faces, boundary_faces);
    }
}

TEST(MixedCells, CellsOfEitherHandednessAreTaken) {
    Mixed turned = box_of_prisms(2);
    for (std::size_t c = 0; c < turned.others.prisms.size(); c += 3) {
        auto& prism = turned.others.prisms[c];
        prism = {prism[3], prism[4], prism[5], prism[0], prism[1], prism[2]};
    }
    EXPECT_NEAR(report_of(turned).volume, 8, 8 * kRounding);

    turned = chessboard_of_pyramids(2);
    for (auto& pyramid : turned.others.pyramids) std::reverse(pyramid.begin(), pyramid.begin() + 4);
    std::swap_ranges(turned.hexes.cells[0].begin(), turned.hexes.cells[0].begin() + 4, turned.hexes.cells[0].begin() + 4);
    EXPECT_NEAR(report_of(turned).volume, 8, 8 * kRounding);
    EXPECT_EQ(report_of(turned).inverted_cells, 0u);
}

TEST(MixedCells, PointsDoNotDependOnTheOrderOfCells) {
    for (const Mixed& mixed : {box_of_tets(2), box_of_prisms(2), chessboard_of_pyramids(2)}) {
        Mixed shuffled = mixed;
        std::mt19937 random(7);
        std::shuffle(shuffled.hexes.cells.begin(), shuffled.hexes.cells.end(), random);
        std::shuffle(shuffled.others.tets.begin(), shuffled.others.tets.end(), random);
        std::shuffle(shuffled.others.prisms.begin(), shuffled.others.prisms.end(), random);
        std::shuffle(shuffled.others.pyramids.begin(), shuffled.others.pyramids.end(), random);
        HexMesh a = split_into_hexes(mixed.hexes, mixed.others);
        HexMesh b = split_into_hexes(shuffled.hexes, shuffled.others);
        EXPECT_EQ(a.points, b.points);
        std::sort(a.cells.begin(), a.cells.end());
        std::sort(b.cells.begin(), b.cells.end());
        EXPECT_EQ(a.cells, b.cells);
    }
}

TEST(MixedCells, AttributesAreMeansAndUnusedPointsGo) {
    Mixed mixed = chessboard_of_pyramids(2);
    mixed.hexes.points.emplace_back(std::nan(""), 0, 0);
    Attribute field{"f", 2, {}};
    for (const Vec3& x : mixed.hexes.points) {
        field.values.push_back(x.x + 2 * x.y);
        field.values.push_back(x.z);
    }
    mixed.hexes.attributes = {field};
    const HexMesh split = split_into_hexes(mixed.hexes, mixed.others);
    validate(split);
    EXPECT_EQ(inspect(split).points, inspect(split).points_used);
    const auto& values = split.attributes.front().values;
    for (std::size_t p = 0; p < split.points.size(); ++p) {
        EXPECT_NEAR(values[2 * p], split.points[p].x + 2 * split.points[p].y, kRounding);
        EXPECT_NEAR(values[2 * p + 1], split.points[p].z, kRounding);
    }
}

TEST(MixedCells, WhatIsNoMeshIsRefused) {
    const auto refuse = [](const std::string& part, const HexMesh& hexes, const MixedCells& others) {
        expect_error(ErrorCode::InvalidInput, part, [&] { static_cast<void>(split_into_hexes(hexes, others)); });
    };
    const HexMesh points = only_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
    refuse("no cell", points, {});
    refuse("tetrahedron 1: there is no point 5", points, {{{0, 1, 2, 3}, {1, 2, 3, 5}}, {}, {}});
    refuse("pyramid 0: point 1 is a corner twice", points, {{}, {}, {{0, 1, 2, 1, 4}}});
    refuse("two cells have the same corners: points 0 1 2 3", points, {{{0, 1, 2, 3}, {2, 3, 1, 0}}, {}, {}});
    HexMesh creased = make_box(1, 1, 1);
    creased.creases = {{0, 1}};
    refuse("creases", creased, {});
    HexMesh short_field = make_box(1, 1, 1);
    short_field.attributes = {{"f", 1, {1, 2, 3}}};
    refuse("attribute \"f\"", short_field, {});
}

TEST(MixedCells, AFaceOfThreeCellsIsFoundAfterwards) {
    const HexMesh points = only_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {0, 0, 2}});
    const HexMesh split = split_into_hexes(points, {{{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 2, 5}}, {}, {}});
    expect_error(ErrorCode::InvalidInput, "has 3 cells", [&] { static_cast<void>(build_topology(split)); });
}

}  // namespace mixed_cells_test

}  // namespace subvol::test
