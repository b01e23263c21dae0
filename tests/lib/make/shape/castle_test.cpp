// SPDX-License-Identifier: Apache-2.0
#include "castle.h"
#include "cube_grid.h"
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

/// The chosen cells.
HexMesh chosen_of(HexMesh mesh, const std::vector<std::uint8_t>& chosen) {
    std::vector<std::array<Index, 8>> cells;
    for (std::size_t c = 0; c < chosen.size(); ++c) {
        if (chosen[c] != 0) cells.push_back(mesh.cells[c]);
    }
    mesh.cells = std::move(cells);
    return without_unused_points(std::move(mesh));
}

/// A grid of cubes of side 1 from 0 to a size, and a rim.
struct Cubes {
    explicit Cubes(const Vec3& size) : grid({Vec3(0.0), size}, 1), divided(grid) {}

    [[nodiscard]] HexMesh cells() const { return divided.cells(std::vector<std::uint8_t>(grid.size(), 1)).mesh; }

    detail::CubeGrid grid;
    detail::DividedCubes divided;
};

/// A flag for each cell: whether a condition holds at its middle.
template <class Condition>
std::vector<std::uint8_t> flags(const HexMesh& mesh, const Condition& condition) {
    std::vector<std::uint8_t> made;
    for (Index c = 0; c < mesh.cells.size(); ++c) made.push_back(condition(detail::middle_of(mesh, c)) ? 1 : 0);
    return made;
}

bool in_box(const Vec3& x, const Vec3& size) {
    return x.x > 0 && x.y > 0 && x.z > 0 && x.x < size.x && x.y < size.y && x.z < size.z;
}

TEST(Castle, BecomesASurfaceWhateverIsChosen) {
    std::mt19937 dice(5);
    std::uniform_real_distribution<float> any(0, 1);
    const Vec3 size(5, 4, 3);
    for (int trial = 0; trial < 10; ++trial) {
        Cubes cubes(size);
        if (trial % 2 == 1) cubes.divided.divide_at({{2.5, 2.5, 1.5}}, 1);
        const HexMesh mesh = cubes.cells();
        std::vector<std::uint8_t> chosen = flags(mesh, [&](const Vec3& x) { return in_box(x, size) && any(dice) > 0.5F; });
        std::vector<float> likeness(chosen.size());
        for (float& l : likeness) l = any(dice);
        const std::vector<std::uint8_t> before = chosen;
        const std::size_t added = detail::make_manifold(mesh, likeness, chosen);
        EXPECT_GT(added, 0U);
        std::size_t more = 0;
        for (std::size_t c = 0; c < before.size(); ++c) {
            EXPECT_GE(chosen[c], before[c]);
            more += chosen[c] - before[c];
        }
        EXPECT_EQ(more, added);
        EXPECT_TRUE(is_surface(chosen_of(mesh, chosen))) << trial;
    }
}

TEST(Castle, KeepsASurfaceAsItIs) {
    const HexMesh mesh = Cubes({3, 3, 3}).cells();
    std::vector<std::uint8_t> chosen = flags(mesh, [](const Vec3& x) { return in_box(x, {3, 2, 1}); });
    EXPECT_EQ(detail::make_manifold(mesh, std::vector<float>(chosen.size(), 1), chosen), 0U);
    EXPECT_EQ(chosen_of(mesh, chosen).cells.size(), 6U);
}

TEST(DividedCubes, FillTheGridWithCellsThatFitTogether) {
    // Two corners of an L and a place apart; some of the cubes again.
    Cubes cubes({9, 8, 7});
    const HexMesh whole = cubes.cells();
    cubes.divided.divide_at({{2.5, 2.5, 2.5}, {5.5, 2.5, 2.5}, {5.5, 5.5, 2.5}, {2.5, 6.5, 5.5}}, 2);
    const std::size_t once = cubes.divided.count();
    EXPECT_EQ(once, 4 * 27U);
    for (int level = 1; level <= 2; ++level) {
        const auto made = cubes.divided.cells(std::vector<std::uint8_t>(cubes.grid.size(), 1));
        EXPECT_NEAR(test::volume_of(made.mesh), test::volume_of(whole), 1e-9);
        const Topology topology = build_topology(made.mesh);
        const Topology before = build_topology(whole);
        const auto hull = [](const Topology& t) {
            return std::ranges::count_if(t.face_cells, [](const auto& cells) { return cells[1] == kNone; });
        };
        EXPECT_EQ(hull(topology), hull(before));  // no face is without its other side
        EXPECT_EQ(topology.nonmanifold_edges, 0U);
        // Where all cubes around one are divided, too, there are its thirds, but for how their neighbours' layers move them.
        std::size_t small = 0;
        for (Index c = 0; c < made.mesh.cells.size(); ++c) {
            const Vec3 middle = detail::middle_of(made.mesh, c);
            if (!in_box(middle - Vec3(2, 2, 2), {1, 1, 1})) continue;
            ++small;
            if (level == 2) continue;
            for (const Index p : made.mesh.cells[c]) {
                for (int axis = 0; axis < 3; ++axis) {
                    EXPECT_NEAR(std::abs(made.mesh.points[p][axis] - middle[axis]), 1.0 / 6, 0.05);
                }
            }
        }
        EXPECT_EQ(small == 27U, level == 1);
        double room = 0;
        for (const double side : made.sides) room += side * side * side;
        EXPECT_NEAR(room, test::volume_of(whole), 1e-9);
        if (level == 1) cubes.divided.divide_at({{2.5, 2.5, 2.5}}, 2);
    }
    EXPECT_EQ(cubes.divided.count(), once + 27);
    const std::size_t twice = cubes.divided.count();
    cubes.divided.divide_at({{2.5, 2.5, 2.5}}, 2);
    EXPECT_EQ(cubes.divided.count(), twice);  // twice at most
}

TEST(WithLayer, LeavesCellsOneSideAtTheBoundaryAndKeepsThemSound) {
    const HexMesh all = Cubes({4, 4, 4}).cells();
    std::vector<std::uint8_t> chosen = flags(all, [](const Vec3& x) {
        return in_box(x, {4, 4, 4}) && x.x + x.y + x.z < 5;
    });  // steps
    detail::make_manifold(all, std::vector<float>(chosen.size(), 1), chosen);
    const HexMesh cubes = chosen_of(all, chosen);
    const HexMesh mesh = detail::with_layer_at_walls(cubes).mesh;
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
