// SPDX-License-Identifier: Apache-2.0
// What readers of all formats share: grids, names, blocks, steps, parts of cells, systems of axes, kinds of VTK's cells.
#include "mesh_file.h"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "local_system.h"
#include "made_files.h"
#include "vtk_cells.h"

namespace subvol::detail {
namespace mesh_file_test {

using test::add_cell;
using test::assembled;
using test::error_of;
using test::file_of;
using test::make_box;
using test::open_area;
using test::volume_of;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(StructuredGrids, FillTheBoxOfTheirPlanes) {
    MeshFile file;
    file.points = {{9, 9, 9}};  // of a block before
    add_points(file, {std::vector<double>{0, 1, 3}, {0, 2}, {-1, 0, 0.5, 4}}, 0);
    const StructuredGrid grid{{3, 2, 4}};
    add_hexes(file, grid, 1, 7);
    EXPECT_EQ(file.points.size(), 1 + grid.point_count());
    EXPECT_EQ(file.hexes.corners.size(), grid.cell_count());
    EXPECT_EQ(file.hexes.numbers.front(), 7U);
    EXPECT_EQ(file.hexes.numbers.back(), 7U + 5);
    file.hexes.numbers.clear();
    const ReadResult result = assembled(file);
    EXPECT_EQ(volume_of(result.mesh), 3. * 2 * 5);
    EXPECT_EQ(open_area(result.mesh), 2 * (3 * 2 + 2 * 5 + 3 * 5));
    EXPECT_EQ(test::least_volume(result.mesh), 1 * 2 * 0.5);
    EXPECT_EQ(size_text(grid), "3 x 2 x 4 points");
}

TEST(StructuredGrids, SizesDoNotOverflow) {
    constexpr std::size_t kHuge = std::size_t{1} << 63;
    EXPECT_EQ((StructuredGrid{{kHuge, 2, 1}}.point_count()), kNone);
    EXPECT_EQ((StructuredGrid{{kHuge, kHuge, kHuge}}.point_count()), kNone);
    EXPECT_EQ((StructuredGrid{{kHuge, kHuge, 0}}.point_count()), 0U);
    EXPECT_EQ((StructuredGrid{{1 << 16, 1 << 16, 1}}.point_count()), kNone) << "2^32";
    EXPECT_EQ((StructuredGrid{{1 << 10, 1 << 10, 1 << 10}}.point_count()), 1U << 30);
    EXPECT_EQ((StructuredGrid{{1 << 16, 1 << 16, 1}}.cell_count()), 0U) << "points without a cell between them";
    EXPECT_EQ((StructuredGrid{{0, 5, 5}}.cell_count()), 0U);
    EXPECT_GE(most_points(0), 1000U);
    EXPECT_GE(most_points(1 << 20), 1U << 20);
}

TEST(FileContents, SymmetricTensorsAreOrdered) {
    // xx, yy, zz, xy, yz, xz of a file that has xx, xy, xz, yy, yz, zz; what is no whole tensor stays.
    std::vector<double> values{11, 12, 13, 22, 23, 33, 1, 2, 3, 4, 5, 6, 7};
    order_symmetric(values, kSymmetricByRows);
    EXPECT_THAT(values, ElementsAre(11, 22, 33, 12, 23, 13, 1, 4, 6, 2, 5, 3, 7));
}

TEST(FileContents, BlocksAreChosenByTheirNames) {
    const std::vector<std::string> there{"Rotor", "stator", "ROTOR", "shaft"};
    const auto taken = [&](const std::vector<std::string>& wanted) {
        const BlockChoice choice(wanted, there, "a.cgns");
        std::string names;
        for (const std::string& name : there) names += choice.takes(name) ? name + " " : "";
        return names;
    };
    EXPECT_EQ(taken({}), "Rotor stator ROTOR shaft ");
    EXPECT_EQ(taken({"Rotor"}), "Rotor ");
    EXPECT_EQ(taken({"rotor", "SHAFT"}), "Rotor ROTOR shaft ");
    EXPECT_THAT(error_of([&] { taken({"shaft", "hub"}); }), HasSubstr("a.cgns: there is no block \"hub\" (it has: Rotor"));
    EXPECT_THAT(error_of([&] { BlockChoice(std::vector<std::string>{"hub"}, {}, "a.cgns"); }), HasSubstr("it has none"));
}

TEST(FileContents, TheLastStepIsReadUnlessOneIsChosen) {
    std::vector<std::string> warnings;
    EXPECT_EQ(chosen_step({}, 1, "a", warnings), 0U);
    EXPECT_TRUE(warnings.empty());
    EXPECT_EQ(chosen_step({}, 5, "a", warnings), 4U);
    EXPECT_THAT(warnings, ElementsAre(HasSubstr("5 steps")));
    EXPECT_EQ(chosen_step({.step = 4}, 5, "a", warnings), 4U);
    EXPECT_EQ(warnings.size(), 1U);
    EXPECT_EQ(error_of([&] { static_cast<void>(chosen_step({.step = 5}, 5, "a", warnings)); }),
              "a: there is no step 5 (steps are 0 to 4)");
    EXPECT_EQ(error_of([&] { static_cast<void>(chosen_step({.step = 1}, 1, "a", warnings)); }),
              "a: there is no step 1 (it has one step, number 0)");
}

TEST(FileContents, ManyThingsAreListedInOneSentence) {
    std::vector<std::string> warnings;
    std::vector<IgnoredPart> ignored;
    LeftOut few, many;
    few.report("field", "fields", warnings, ignored);
    few.add("T", "it is damaged");
    few.report("field", "fields", warnings, ignored);
    for (int k = 0; k < 9; ++k) many.add("f" + std::to_string(k), k == 0 ? "first" : "later");
    many.report("field", "fields", warnings, ignored);
    EXPECT_THAT(warnings, ElementsAre("field \"T\" left out: it is damaged",
                                      "9 fields left out (\"f0\", \"f1\", \"f2\", \"f3\", \"f4\", \"f5\", …): first"));
    ASSERT_EQ(ignored.size(), 10U);
    EXPECT_EQ(ignored[9].kind + ignored[9].name + ignored[9].reason, "fieldf8later");
    NamesApart apart("array");
    std::set<std::string> names;
    for (int k = 0; k < 3; ++k) {
        for (const std::string name : {"a", "b", "a_2", ""}) EXPECT_TRUE(names.insert(apart.take(name)).second) << name;
    }
    EXPECT_TRUE(names.contains("unnamed"));
    warnings.clear();
    apart.report(warnings);
    EXPECT_EQ(warnings.size(), 4U) << "one for each name";
}

TEST(FileContents, PointsAreNamedAsInTheFile) {
    EXPECT_EQ((EntityNames{"vertex", "hex", 1}.point(12)), "vertex 13");
    EXPECT_EQ((EntityNames{"vertex", "hex", 1}.cell(0)), "hex 1");
    const std::vector<std::int64_t> numbers{100, 7};
    EXPECT_EQ((EntityNames{"node", "element", 1, numbers}.point(1)), "node 7");
}

TEST(FileContents, FacesAndEdgesOfCellsAreNoShells) {
    MeshFile file = file_of(make_box(2, 1, 1));
    file.points.emplace_back(9, 9, 9);
    const std::vector<std::array<Index, 4>> faces{{0, 3, 4, 1}, {4, 10, 7, 1}, {1, 7, 10, 4}};  // of the hull, and inside
    for (const auto& face : faces) add_cell(file, file.quads, face);
    add_cell(file, file.quads, {0, 2, 5, 3});   // two faces together
    add_cell(file, file.quads, {0, 1, 4, 12});  // a point of no cell
    add_cell(file, file.lines, {1, 0});
    add_cell(file, file.lines, {0, 4});  // a diagonal
    MeshFile without = file;
    EXPECT_EQ(drop_parts_of_cells(without, false), (std::array<std::size_t, 2>{3, 1}));
    EXPECT_THAT(without.quads.numbers, ElementsAre(5, 6));
    EXPECT_THAT(without.lines.numbers, ElementsAre(8));
    MeshFile mixed = file;
    add_cell(mixed, mixed.tets, {0, 1, 2, 12});
    EXPECT_EQ(drop_parts_of_cells(mixed, false), (std::array<std::size_t, 2>{5, 2})) << "beside other cells: all of them";
    MeshFile shells = file;
    shells.hexes = {};
    MeshFile copy = shells;
    EXPECT_EQ(drop_parts_of_cells(copy, true), (std::array<std::size_t, 2>{0, 0}));
    EXPECT_EQ(drop_parts_of_cells(shells, false), (std::array<std::size_t, 2>{5, 2}));
    EXPECT_EQ(error_of([&] {
                  add_left_out_warning(shells, {{"cell type", "VERTEX", 2}}, "a.vtk");
              }),
              "a.vtk: no hexahedra, but 2 elements of type VERTEX, which are ignored");
}

TEST(LocalSystems, AnglesAreThoseOfTheirAxes) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> any(-2, 2);
    for (int k = 0; k < 20; ++k) {
        const Vec3 x(any(random), any(random), any(random));
        const double around = std::atan2(x.y, x.x), across = std::hypot(x.x, x.y), length = glm::length(x);
        const auto expect_x = [&](Coordinates kind, const Vec3& at) {
            EXPECT_NEAR(glm::distance(rectangular(kind, at), x), 0, 1e-14);
        };
        expect_x(Coordinates::Rectangular, x);
        expect_x(Coordinates::Cylindrical, {across, around, x.z});
        expect_x(Coordinates::Spherical, {length, around, std::asin(x.z / length)});
        expect_x(Coordinates::Polar, {length, around, std::acos(x.z / length)});
        const Vec3 y(any(random), any(random), any(random));
        const auto axes = axes_along(x, y);
        EXPECT_NEAR(glm::determinant(Mat3(axes[0], axes[1], axes[2])), 1, 1e-12) << "right-handed";
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
                EXPECT_NEAR(glm::dot(axes[static_cast<std::size_t>(a)], axes[static_cast<std::size_t>(b)]), a == b ? 1 : 0,
                            1e-12);
            }
        }
        EXPECT_NEAR(glm::dot(axes[0], x), length, 1e-14);
        EXPECT_GT(glm::dot(axes[1], y), 0);
        EXPECT_NEAR(glm::dot(axes[2], y), 0, 1e-12);
        const LocalSystem system{{1, 2, 3}, axes};
        EXPECT_NEAR(glm::distance(system({length, 0, 0}), Vec3(1, 2, 3) + x), 0, 1e-12);
    }
    EXPECT_FALSE(std::isfinite(axes_along({1, 2, 3}, {2, 4, 6})[1].x));
    EXPECT_FALSE(std::isfinite(axes_along({0, 0, 0}, {2, 4, 6})[0].x));
}

/// Cells of a VTK file over the points of a box of 2 × 1 × 1 cells.
class VtkCells : public testing::Test {
protected:
    /// Takes the cells; ends the file if it is given.
    MeshFile take(const std::vector<std::pair<std::int64_t, std::vector<Index>>>& cells, const ReadOptions& options = {},
                  const char* name = "a.vtk") {
        const TextScanner in("line\nline\n", "a.vtk", TextScanner::Comments::None);
        MeshFile file;
        file.points = points;
        VtkCellSorter sorter(in, file, options);
        for (const auto& [type, corners] : cells) sorter.take(type, corners, 5);
        sorter.report(name != nullptr ? std::optional<std::string_view>(name) : std::nullopt);
        return file;
    }

    std::vector<Vec3> points = make_box(2, 1, 1).points;
    std::vector<Index> hex{0, 1, 4, 3, 6, 7, 10, 9};
};

TEST_F(VtkCells, OfEveryTypeHaveTheirVolume) {
    for (const auto& [type, corners, volume] : {std::tuple{12, hex, 1.},
                                                {11, std::vector<Index>{0, 1, 3, 4, 6, 7, 9, 10}, 1.},
                                                {10, hex, 1.},
                                                {10, std::vector<Index>{0, 1, 3, 6}, 1 / 6.},
                                                {13, std::vector<Index>{0, 1, 3, 6, 7, 9}, 1 / 2.},
                                                {14, std::vector<Index>{0, 1, 4, 3, 6}, 1 / 3.},
                                                {24, std::vector<Index>{0, 1, 3, 6, 2, 2, 2, 2, 2, 2}, 1 / 6.},
                                                {41, hex, 1.},
                                                {41, std::vector<Index>{0, 1, 3, 6, 7}, 1 / 3.}}) {
        const MeshFile file = take({{type, corners}});
        EXPECT_NEAR(volume_of(assembled(file).mesh), volume, 1e-14) << type;
        each_kind(file, [](const auto& kind) { EXPECT_THAT(kind.numbers, testing::Each(0U)); });
    }
}

TEST_F(VtkCells, PrismsOverPolygonsAreSplit) {
    for (const int sides : {5, 6}) {
        points.clear();
        std::vector<Index> corners;
        for (int k = 0; k < 2 * sides; ++k) {
            const double angle = 2 * std::numbers::pi * k / sides;
            corners.push_back(static_cast<Index>(points.size()));
            points.emplace_back(std::cos(angle), std::sin(angle), k < sides ? 0 : 3);
        }
        const MeshFile file = take({{sides + 10, corners}});
        EXPECT_NEAR(volume_of(assembled(file).mesh), 3 * sides * std::sin(2 * std::numbers::pi / sides) / 2, 1e-12);
        EXPECT_THAT(error_of([&] {
                        take({{sides + 10, corners}}, {.other_cells = OtherCells::Ignore});
                    }),
                    HasSubstr("a.vtk: no hexahedra, but 1 " + std::string(sides == 5 ? "pentagonal" : "hexagonal") + " prism"));
    }
}

TEST_F(VtkCells, AreNumberedThroughAllTypes) {
    const MeshFile file =
        take({{1, {0}}, {12, hex}, {9, {1, 2, 5, 4}}, {10, {1, 2, 4, 7}}, {14, {2, 5, 11, 8, 1}}, {9, {0, 1, 4, 3}}});
    EXPECT_THAT(file.hexes.numbers, ElementsAre(1));
    EXPECT_THAT(file.tets.numbers, ElementsAre(3));
    EXPECT_THAT(file.pyramids.numbers, ElementsAre(4));
    EXPECT_THAT(file.warnings, ElementsAre("1 vertex (VTK type 1), 2 quads (VTK type 9) ignored"));
    const MeshFile shells = take({{12, hex}, {9, {1, 2, 5, 4}}, {9, {0, 1, 4, 3}}, {3, {2, 8}}});
    EXPECT_THAT(shells.quads.numbers, ElementsAre(1)) << "the other one is a face of the hexahedron";
    EXPECT_THAT(shells.lines.numbers, ElementsAre(3));
    const MeshFile part = take({{9, {1, 2, 5, 4}}}, {}, nullptr);
    EXPECT_TRUE(part.quads.corners.empty()) << "parts of a mesh have no shells";
    EXPECT_THAT(part.warnings, ElementsAre("1 quad (VTK type 9) ignored"));
}

TEST_F(VtkCells, WithAWrongNumberOfCornersAreRefused) {
    for (const auto& [type, corners, message] : {std::tuple{12, 7, "cell 1 has 7 corners (a hexahedron has 8)"},
                                                 {12, 9, "cell 1 has 9 corners"},
                                                 {13, 5, "cell 1 has 5 corners (a wedge has 6)"},
                                                 {14, 6, "cell 1 has 6 corners (a pyramid has 5)"},
                                                 {10, 3, "cell 1 has 3 corners (a tetrahedron has 4)"},
                                                 {25, 7, "cell 1 has 7 corners (a hexahedron has 8)"}}) {
        EXPECT_THAT(error_of([&, kind = type, count = static_cast<std::size_t>(corners)] {
                        take({{12, hex}, {kind, std::vector<Index>(count)}});
                    }),
                    HasSubstr("a.vtk, line 2: " + std::string(message)));
    }
}

TEST_F(VtkCells, PointSetsThatAreNotConvexAreLeftOut) {
    points.emplace_back(0.5, 0.5, 0.5);
    std::vector<Index> with_middle = hex, repeated = hex;
    with_middle.push_back(12);
    repeated.insert(repeated.end(), hex.begin(), hex.end());
    const MeshFile file = take({{41, with_middle}, {41, repeated}});
    EXPECT_THAT(file.hexes.numbers, ElementsAre(1));
    EXPECT_THAT(file.warnings, Contains("1 convex point set (VTK type 41) ignored"));
}

}  // namespace mesh_file_test
}  // namespace subvol::detail
