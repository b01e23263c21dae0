// SPDX-License-Identifier: Apache-2.0
// Corners of small cells in the middle of edges and faces of larger ones, joined by welding.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

#include "made_files.h"

namespace subvol::detail {
namespace hanging_points_test {

using test::add_at_cells;
using test::add_at_points;
using test::assembled;
using test::file_of;
using test::make_box;
using test::open_area;
using test::value_at;
using test::volume_of;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kRounding = 1e-12;

/// Adds a box of cells with points of its own.
void add_box(HexMesh& mesh, const Vec3& lower, const Vec3& size, std::array<Index, 3> cells) {
    const HexMesh box = make_box(cells[0], cells[1], cells[2]);
    const auto first = static_cast<Index>(mesh.points.size());
    for (const Vec3& x : box.points) {
        mesh.points.push_back(lower + size * x / Vec3(cells[0], cells[1], cells[2]));
    }
    for (auto cell : box.cells) {
        for (Index& p : cell) p += first;
        mesh.cells.push_back(cell);
    }
}

/// How the unit cube at the side x = 1 of another one is cut, with the points that hang then on this side.
struct Cut {
    std::array<Index, 3> cells;
    std::size_t hanging;
};

MeshFile cubes(const Cut& cut, bool small_ones_first = false) {
    HexMesh mesh;
    if (!small_ones_first) add_box(mesh, {0, 0, 0}, Vec3(1), {1, 1, 1});
    add_box(mesh, {1, 0, 0}, Vec3(1), cut.cells);
    if (small_ones_first) add_box(mesh, {0, 0, 0}, Vec3(1), {1, 1, 1});
    return file_of(mesh);
}

/// Halves in one direction or in both.
const std::array kCuts{Cut{{2, 2, 2}, 5}, Cut{{1, 2, 2}, 5}, Cut{{1, 2, 1}, 2}, Cut{{2, 1, 2}, 2}};

TEST(HangingPoints, AreJoinedSoThatAllCellsFitTogether) {
    for (const Cut& cut : kCuts) {
        for (const bool small_ones_first : {false, true}) {
            const std::string which = std::to_string(cut.cells[1]) + " x " + std::to_string(cut.cells[2]) + " at the side" +
                                      (small_ones_first ? ", small ones first" : "");
            const ReadResult result = assembled(cubes(cut, small_ones_first), {.weld = 0});
            EXPECT_THAT(result.warnings, Contains("1 cell with hanging points split so that all cells fit together")) << which;
            EXPECT_NEAR(volume_of(result.mesh), 2, kRounding) << which;
            EXPECT_NEAR(open_area(result.mesh), 10, kRounding) << which << ": nothing is open between the cells";
            EXPECT_GT(test::least_volume(result.mesh), 0) << which;
        }
    }
}

// The cells of a box are whole or cut along y, along y and z, or along all axes; into halves, and into halves and quarters.
TEST(HangingPoints, AreJoinedInAnyMixtureOfHalves) {
    constexpr std::array<std::array<Index, 3>, 4> kHalves{{{1, 1, 1}, {1, 2, 1}, {1, 2, 2}, {2, 2, 2}}},
        kQuarters{{{1, 1, 1}, {1, 2, 1}, {1, 4, 2}, {2, 4, 4}}};
    std::mt19937 random(5);
    for (int round = 0; round < 20; ++round) {
        const auto& ways = round % 2 == 0 ? kHalves : kQuarters;
        HexMesh mesh;
        for (int cell = 0; cell < 27; ++cell) {
            add_box(mesh, {cell % 3, cell / 3 % 3, cell / 9}, Vec3(1), ways[random() % 4]);
        }
        const ReadResult result = assembled(file_of(mesh), {.weld = 0});
        EXPECT_NEAR(volume_of(result.mesh), 27, 1e-11) << round;
        EXPECT_NEAR(open_area(result.mesh), 54, 1e-10) << round;
        if (&ways == &kHalves) {  // faces with three points on each of three sides have flat triangles
            EXPECT_GT(test::least_volume(result.mesh), 0) << round;
        }
    }
}

TEST(HangingPoints, AreCountedWhereTheyAreNotJoined) {
    for (const Cut& cut : kCuts) {
        HexMesh mesh;
        add_box(mesh, {0, 0, 0}, Vec3(1), {1, 1, 1});
        add_box(mesh, {1, 0, 0}, Vec3(1), cut.cells);
        // Cells at the same place share their points.
        for (auto& cell : mesh.cells) {
            for (Index& p : cell) p = static_cast<Index>(std::ranges::find(mesh.points, mesh.points[p]) - mesh.points.begin());
        }
        const ReadResult result = assembled(file_of(mesh));
        EXPECT_THAT(result.warnings, ElementsAre(HasSubstr(std::to_string(cut.hanging) + " points hang in the middle")));
        EXPECT_NEAR(open_area(result.mesh), 10 + 2, kRounding) << "both sides of the square between the cells are open";
    }
}

// Quarters beside the cube: the middles of edges are found again in the halves.
TEST(HangingPoints, OfQuartersAreJoined) {
    const ReadResult result = assembled(cubes({{4, 4, 4}, 21}), {.weld = 0});
    EXPECT_NEAR(volume_of(result.mesh), 2, kRounding);
    EXPECT_NEAR(open_area(result.mesh), 10, kRounding);
}

// A bent cell beside others that lie in the middle of its bent edges.
TEST(HangingPoints, LieInTheMiddleOfBentFacesToo) {
    MeshFile file = cubes(kCuts[0]);
    const auto bend = [](const Vec3& x) { return x + Vec3(0.1 * x.y * x.z, 0.2 * x.x, -0.1 * x.x * x.y); };
    for (Vec3& x : file.points) x = bend(x);
    const ReadResult result = assembled(file, {.weld = 1e-9});
    EXPECT_THAT(result.warnings, Contains(HasSubstr("1 cell with hanging points split")));
    EXPECT_GT(test::least_volume(result.mesh), 0);
    std::size_t inside = 0;
    for (const Vec3& x : result.mesh.points) inside += glm::distance(x, bend({1, 0.5, 0.5})) < 1e-12;
    EXPECT_EQ(inside, 1U);
}

TEST(HangingPoints, AreThoseInTheMiddleAlone) {
    for (const double off : {0., 1e-5, 0.02}) {
        MeshFile file = cubes(kCuts[2]);
        for (Vec3& x : file.points) {
            if (x.y == 0.5) x.y += off;
        }
        const ReadResult result = assembled(file, {.weld = 0});
        EXPECT_NEAR(open_area(result.mesh), off < 0.01 ? 10 : 12, 1e-4) << off;
    }
    // Cells that become larger from place to place, as those of boundary layers, have no such points.
    HexMesh layers = make_box(6, 2, 2);
    for (Vec3& x : layers.points) x.x = std::exp2(x.x);
    EXPECT_TRUE(assembled(file_of(layers)).warnings.empty());
    EXPECT_EQ(assembled(file_of(layers), {.weld = 0}).mesh.cells.size(), 24U);
}

TEST(HangingPoints, KeepTheirValuesAndCellsTheirs) {
    MeshFile file = cubes(kCuts[0]);
    const auto linear = [](const Vec3& x) { return 3 * x.x - 2 * x.y + x.z + 0.25; };
    add_at_points(file, "linear", linear);
    add_at_points(file, "square", [](const Vec3& x) { return x.x == 1 ? x.y * x.y : 0; });
    add_at_cells(file, "T", {7.5, 1, 2, 3, 4, 5, 6, 7, 8});
    const ReadResult result = assembled(file, {.weld = 0});
    for (const Vec3& x : result.mesh.points) {
        EXPECT_NEAR(value_at(result.mesh, "linear", x), linear(x), kRounding);
    }
    EXPECT_EQ(value_at(result.mesh, "square", {1, 0.5, 0.5}), 0.25) << "as the small cells have it";
    // The middle of the large cell has the mean of its points: 8 corners and 5 hanging points.
    EXPECT_NEAR(value_at(result.mesh, "square", {9 / 13., 0.5, 0.5}), (3 + 3 / 4.) / 13, kRounding);
    EXPECT_EQ(value_at(result.mesh, "T", {0, 0, 0}), 7.5);
    EXPECT_EQ(value_at(result.mesh, "T", {2, 0, 0}), 2);
}

}  // namespace hanging_points_test
}  // namespace subvol::detail
