// SPDX-License-Identifier: Apache-2.0
#include "castle.h"
#include "layers.h"

#include <gtest/gtest.h>

#include <random>

#include "lib/volume_of.h"
#include "shape_fitter.h"
#include "subvol/mesh_report.h"
#include "subvol/topology.h"

namespace subvol {
namespace castle_test {

/// How often each cell has a side at the boundary, and whether the boundary is a surface at every edge and corner.
bool is_surface(const HexMesh& mesh) {
    const Topology topology = build_topology(mesh);
    if (topology.nonmanifold_edges > 0) return false;
    // Around a corner the faces of the boundary are one ring: as many as its edges there, and joined.
    for (Index p = 0; p < topology.point_count; ++p) {
        if (topology.point_on_boundary[p] == 0) continue;
        std::vector<Index> faces;
        for (Index f = 0; f < topology.faces.size(); ++f) {
            if (topology.face_on_hull(f) && std::ranges::count(topology.faces[f], p) > 0) faces.push_back(f);
        }
        std::vector<Index> reached{faces.front()};
        for (std::size_t k = 0; k < reached.size(); ++k) {
            for (const Index f : faces) {
                if (std::ranges::count(reached, f) > 0) continue;
                for (const Index e : topology.face_edges[f]) {
                    const auto& [a, b] = topology.edges[e];
                    const bool here = a == p || b == p;
                    if (here && std::ranges::count(topology.face_edges[reached[k]], e) > 0 &&
                        std::ranges::count(reached, f) == 0) {
                        reached.push_back(f);
                    }
                }
            }
        }
        if (reached.size() != faces.size()) return false;
    }
    return true;
}

TEST(CubeGrid, BecomesASurfaceWhateverIsChosen) {
    std::mt19937 dice(5);
    std::uniform_real_distribution<float> likeness(0, 1);
    for (int trial = 0; trial < 10; ++trial) {
        detail::CubeGrid grid({{0, 0, 0}, {5, 4, 3}}, 1);
        std::vector<float> chosen(grid.size(), 0);
        for (std::size_t c = 0; c < chosen.size(); ++c) {
            const Vec3 x = grid.center(c);
            if (x.x > 0 && x.y > 0 && x.z > 0 && x.x < 5 && x.y < 4 && x.z < 3) chosen[c] = likeness(dice);
        }
        grid.choose(chosen);
        const std::vector<std::uint8_t> before = grid.chosen();
        grid.make_manifold();
        for (std::size_t c = 0; c < before.size(); ++c) EXPECT_GE(grid.chosen()[c], before[c]);
        EXPECT_TRUE(is_surface(grid.cells())) << trial;
    }
}

TEST(CubeGrid, KeepsASurfaceAsItIs) {
    detail::CubeGrid grid({{0, 0, 0}, {3, 3, 3}}, 1);
    std::vector<float> chosen(grid.size(), 0);
    for (std::size_t c = 0; c < chosen.size(); ++c) {
        const Vec3 x = grid.center(c);
        if (x.x > 0 && x.y > 0 && x.z > 0 && x.x < 3 && x.y < 2 && x.z < 1) chosen[c] = 1;  // 3 × 2 × 1
    }
    grid.choose(chosen);
    grid.make_manifold();
    EXPECT_EQ(grid.cells().cells.size(), 6U);
}

TEST(WithLayer, LeavesCellsOneSideAtTheBoundaryAndKeepsThemSound) {
    detail::CubeGrid grid({{0, 0, 0}, {4, 4, 4}}, 1);
    std::vector<float> chosen(grid.size(), 0);
    for (std::size_t c = 0; c < chosen.size(); ++c) {
        const Vec3 x = grid.center(c);
        if (x.x > 0 && x.y > 0 && x.z > 0 && x.x + x.y + x.z < 5) chosen[c] = 1;  // steps
    }
    grid.choose(chosen);
    grid.make_manifold();
    const HexMesh cubes = grid.cells();
    const HexMesh mesh = detail::with_layer(cubes);
    const Topology topology = build_topology(mesh);
    std::size_t sides = 0;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        std::size_t here = 0;
        for (const Index f : topology.cell_faces[c]) here += topology.face_on_hull(f) ? 1 : 0;
        EXPECT_LE(here, 1U);
        sides += here;
    }
    EXPECT_EQ(mesh.cells.size(), cubes.cells.size() + sides);
    EXPECT_GT(measure_cells(mesh).min_scaled_jacobian, 0.2);
    const double volume = test::volume_of(mesh), before = test::volume_of(cubes);
    EXPECT_NEAR(volume, before, 1e-9);  // the boundary stays where it is
}

}  // namespace castle_test
}  // namespace subvol
