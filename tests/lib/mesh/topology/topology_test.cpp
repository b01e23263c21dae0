// SPDX-License-Identifier: Apache-2.0
#include "subvol/topology.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/detail/child_topology.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"
#include "subvol/model.h"
#include "subvol/surface.h"

namespace subvol {
namespace topology_test {

TEST(Topology, CountsABox) {
    const auto report = inspect(test::make_box(2, 2, 2));
    EXPECT_EQ(report.points, 27u);
    EXPECT_EQ(report.edges, 54u);
    EXPECT_EQ(report.faces, 36u);
    EXPECT_EQ(report.boundary_faces, 24u);
    EXPECT_EQ(report.interior_edges, 6u);
    EXPECT_EQ(report.interior_edge_valence, (std::map<int, std::size_t>{{4, 6}}));
    EXPECT_DOUBLE_EQ(report.volume, 8);
}

TEST(Topology, FindsTheIrregularEdgesOfNestedCubes) {
    const auto report = inspect(test::make_nested_cubes(2));
    EXPECT_EQ(report.singular_nodes, 8u);
    EXPECT_EQ(report.interior_edge_valence.at(3), 12u * 2 + 8u * 2);  // the inner cube's edges and the diagonals
    EXPECT_NEAR(report.volume, 8, 1e-12);
    EXPECT_GT(report.min_scaled_jacobian, .5);
    EXPECT_EQ(report.nonmanifold_edges, 0u);
}

TEST(Topology, RingsGoFromFaceToFaceThroughTheCellBetween) {
    const Topology t = build_topology(test::make_nested_cubes(2));
    for (std::size_t e = 0; e < t.edges.size(); ++e) {
        const auto faces = t.edge_faces[e], cells = t.edge_cells[e];
        const bool boundary = t.edge_on_boundary[e];
        ASSERT_EQ(faces.size(), cells.size() + (boundary ? 1 : 0));
        EXPECT_EQ(t.edge_has_ring[e], !boundary);
        for (std::size_t j = 0; j < cells.size(); ++j) {
            const auto& sides = t.cell_faces[cells[j]];
            EXPECT_NE(std::find(sides.begin(), sides.end(), faces[j]), sides.end());
            EXPECT_NE(std::find(sides.begin(), sides.end(), faces[(j + 1) % faces.size()]), sides.end());
        }
        if (boundary) {
            EXPECT_TRUE(t.face_on_boundary(faces.front()) && t.face_on_boundary(faces.back()));
        } else {
            EXPECT_EQ(faces.front(), *std::min_element(faces.begin(), faces.end()));
        }
    }
}

TEST(Topology, DoesNotDependOnThreadsOrCellOrder) {
    HexMesh mesh = test::make_nested_cubes(2);
    const Topology many = build_topology(mesh);
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    const Topology one = build_topology(mesh);
    EXPECT_EQ(many.edge_faces.values, one.edge_faces.values);
    EXPECT_EQ(many.edge_cells.values, one.edge_cells.values);
    EXPECT_EQ(many.point_edges.values, one.point_edges.values);
    std::reverse(mesh.cells.begin(), mesh.cells.end());
    const Topology reversed = build_topology(mesh);
    EXPECT_EQ(many.edges, reversed.edges);
    EXPECT_EQ(many.faces, reversed.faces);
    EXPECT_EQ(many.edge_faces.values, reversed.edge_faces.values);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        EXPECT_EQ(many.cell_ordinal[c], reversed.cell_ordinal[mesh.cells.size() - 1 - c]);
    }
}

// Several parts, whose counts several threads find together.
TEST(Topology, CountsPartsByAnyThreads) {
    constexpr std::size_t n = 40;
    const HexMesh mesh = make_model("twist", n);
    const auto check = [](const MeshReport& report) {
        EXPECT_EQ(report.points_used, (n + 1) * (n + 1) * (n + 1));
        EXPECT_EQ(report.edges, 3 * n * (n + 1) * (n + 1));
        EXPECT_EQ(report.faces, 3 * n * n * (n + 1));
        EXPECT_EQ(report.boundary_faces, 6 * n * n);
        EXPECT_EQ(report.interior_edges, 3 * n * (n - 1) * (n - 1));
        EXPECT_EQ(report.interior_edge_valence, (std::map<int, std::size_t>{{4, report.interior_edges}}));
        EXPECT_EQ(report.singular_nodes + report.nonmanifold_edges + report.nonmanifold_points, 0u);
    };
    check(inspect(mesh));
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    check(inspect(mesh));
}

TEST(Topology, ReportsNonManifoldEdges) {
    HexMesh mesh = test::make_box(2, 2, 1);
    mesh.cells = {mesh.cells[0], mesh.cells[3]};  // two cells that share one edge
    const auto report = inspect(mesh);
    EXPECT_EQ(report.nonmanifold_edges, 1u);
    EXPECT_EQ(report.edges, 23u);
    EXPECT_EQ(report.faces, 12u);
}

TEST(Topology, RefusesSharedFacesAndTwins) {
    HexMesh mesh = test::make_box(2, 1, 1);
    HexMesh twin = mesh;
    twin.cells.push_back(twin.cells[0]);
    try {
        (void)build_topology(twin);
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("cells 0 and 2 have the same corners"), std::string::npos) << error.what();
    }
    // A third cell on the face between the two.
    const auto first_new = static_cast<Index>(mesh.points.size());
    for (int k = 0; k < 4; ++k) mesh.points.emplace_back(1.5, k % 2, 2 + k / 2);
    const auto& c = mesh.cells[0];
    mesh.cells.push_back({c[1], c[2], c[6], c[5], first_new, first_new + 1, first_new + 2, first_new + 3});
    try {
        (void)build_topology(mesh);
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("has 3 cells: 0, 1, 2"), std::string::npos) << error.what();
    }
}

TEST(Topology, CountsInvertedAndDegenerateCells) {
    HexMesh mesh = test::make_box(2, 2, 2);
    mesh.points[13] = Vec3(-.2, -.2, -.2);  // the centre pushed beyond a corner
    EXPECT_GE(inspect(mesh).inverted_cells, 1u);
    HexMesh flat = test::make_box(1, 1, 1);
    for (auto& p : flat.points) p.z = 0;
    EXPECT_EQ(inspect(flat).degenerate_cells, 1u);
}

TEST(BoundarySurface, BoundsTheTetrahedraOutwards) {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .03, 5);
    double inside = 0, by_surface = 0;
    for (const auto& cell : mesh.cells) {
        for (const auto& t : split_cell(cell)) {
            const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]], &d = mesh.points[t[3]];
            const double volume = glm::dot(b - a, glm::cross(c - a, d - a)) / 6;
            EXPECT_GT(volume, 0);
            inside += volume;
        }
    }
    const Surface surface = boundary_surface(mesh);
    for (const auto& [a, b, c] : surface.triangles) {
        by_surface += glm::dot(surface.points[a], glm::cross(surface.points[b], surface.points[c])) / 6;
    }
    EXPECT_NEAR(inside, by_surface, 1e-12);
    EXPECT_EQ(surface.triangles.size(), 2u * 6 * 4);
}

TEST(ChildTopology, CountsItsEntities) {
    for (const HexMesh& mesh : {test::make_box(1, 1, 1), test::make_box(3, 2, 4), test::irregular()}) {
        const Topology parent = build_topology(mesh);
        const Topology child = detail::child_topology(parent);
        const detail::EntityCounts counts =
            detail::child_counts({parent.point_count, parent.edges.size(), parent.faces.size(), parent.cells.size()});
        EXPECT_EQ(counts.points, child.point_count);
        EXPECT_EQ(counts.edges, child.edges.size());
        EXPECT_EQ(counts.faces, child.faces.size());
        EXPECT_EQ(counts.cells, child.cells.size());
    }
}

TEST(ChildTopology, RefusesMoreEdgesThanAnIndexCounts) {
    // Near the boundary of a mesh there are more edges than faces. Of the child of a plate of n × n cells, 32 n² edges and 28
    // n² faces: at n = 12,000 the faces can be counted with 32 bits, but not the edges.
    const auto plate = [](std::size_t n) {
        return detail::EntityCounts{.points = 2 * (n + 1) * (n + 1),
                                    .edges = 4 * n * (n + 1) + (n + 1) * (n + 1),
                                    .faces = 2 * n * n + 2 * n * (n + 1),
                                    .cells = n * n};
    };
    const Topology small = build_topology(test::make_box(3, 3, 1));
    EXPECT_EQ(plate(3).edges, small.edges.size());
    EXPECT_EQ(plate(3).faces, small.faces.size());
    EXPECT_NO_THROW(detail::check_child(plate(11'000)));
    if (sizeof(Index) > 4) return;
    const detail::EntityCounts child = detail::child_counts(plate(12'000));
    EXPECT_LT(child.faces, std::size_t{kNone});
    EXPECT_GE(child.edges, std::size_t{kNone});
    test::expect_error(ErrorCode::InvalidInput, "the refined mesh needs " + std::to_string(child.edges) + " edges",
                       [&] { detail::check_child(plate(12'000)); });
}

}  // namespace topology_test
}  // namespace subvol
