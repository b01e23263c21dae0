// SPDX-License-Identifier: Apache-2.0
// The contents of a file as a mesh: cells of every kind, their hands, values at cells and points, shells beside them.
#include "assemble.h"

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "made_files.h"

namespace subvol::detail {
namespace assemble_test {

using test::add_at_cells;
using test::add_at_points;
using test::add_cell;
using test::assembled;
using test::file_of;
using test::kMadeFile;
using test::kMadeNames;
using test::least_volume;
using test::make_box;
using test::open_area;
using test::refusal_of;
using test::value_at;
using test::volume_of;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double kRounding = 1e-13;  // of sums of a few dozen volumes of size 1
const double kNan = std::nan("");

/// The points of a unit tetrahedron, prism, pyramid or cube, moved by an affine map with this determinant.
constexpr double kDeterminant = 2 * 3 * 0.5;
std::vector<Vec3> moved(std::vector<Vec3> points) {
    for (Vec3& x : points) x = {2 * x.x + 0.3 * x.y - 1, 3 * x.y + 0.7 * x.z, 0.5 * x.z};
    return points;
}

struct Kind {
    MeshFile file;
    double volume;
    std::size_t children, points;  // by Euler: one child for each corner; a point for each corner, edge, face and cell
};

/// A tetrahedron, a prism and a pyramid in either hand. The pyramid is cut into two tetrahedra: 9 edges, 7 triangles, 2
/// middles.
std::vector<Kind> kinds() {
    std::vector<Kind> all;
    for (const bool mirrored : {false, true}) {
        Kind tet{{}, kDeterminant / 6, 4, 4 + 6 + 4 + 1};
        tet.file.points = moved({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
        add_cell(tet.file, tet.file.tets, mirrored ? std::array<Index, 4>{1, 0, 2, 3} : std::array<Index, 4>{0, 1, 2, 3});
        Kind prism{{}, kDeterminant / 2, 6, 6 + 9 + 5 + 1};
        prism.file.points = moved({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
        add_cell(prism.file, prism.file.prisms,
                 mirrored ? std::array<Index, 6>{3, 4, 5, 0, 1, 2} : std::array<Index, 6>{0, 1, 2, 3, 4, 5});
        Kind pyramid{{}, kDeterminant / 3, 8, 5 + 9 + 7 + 2};
        pyramid.file.points = moved({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.3, 0.4, 1}});
        add_cell(pyramid.file, pyramid.file.pyramids,
                 mirrored ? std::array<Index, 5>{3, 2, 1, 0, 4} : std::array<Index, 5>{0, 1, 2, 3, 4});
        for (Kind* kind : {&tet, &prism, &pyramid}) all.push_back(std::move(*kind));
    }
    return all;
}

TEST(Assemble, CellsOfEveryKindAndHandKeepTheirVolume) {
    for (const Kind& kind : kinds()) {
        const ReadResult result = assembled(kind.file);
        EXPECT_NEAR(volume_of(result.mesh), kind.volume, kRounding);
        EXPECT_GT(least_volume(result.mesh), 0);
        EXPECT_EQ(result.mesh.cells.size(), kind.children);
        EXPECT_EQ(result.mesh.points.size(), kind.points);
        EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("split into " + std::to_string(kind.children) + " hexahedra")));
    }
}

/// A cube with a pyramid on its top and a prism at its side x = 1, whose slope goes down to (2, y, 0).
MeshFile cube_with_neighbours() {
    MeshFile file = file_of(make_box(1, 1, 1));
    file.points.insert(file.points.end(), {{0.5, 0.5, 1.5}, {2, 0, 0}, {2, 1, 0}});
    const auto cell = file.hexes.corners.front();
    add_cell(file, file.pyramids, {cell[4], cell[5], cell[6], cell[7], 8});
    add_cell(file, file.prisms, {cell[1], cell[5], 9, cell[2], cell[6], 10});
    return file;
}

TEST(Assemble, RangesAreThoseOfWhatIsRead) {
    MeshFile file = file_of(make_box(1, 1, 1));
    file.points.insert(file.points.end(), {{9, 0, 0}, {9, 1, 0}});  // of bars that are not read, elements 1 and 2
    file.arrays.push_back({"T", 1, false, {1, 2, 3, 4, 5, 6, 7, 8, -900, 4000}});
    file.arrays.push_back({"stress", 1, true, {50, -900, 4000}});
    const ReadResult result = assembled(file);
    ASSERT_EQ(result.fields.size(), 2U);
    EXPECT_EQ(result.fields[0].min, 1);
    EXPECT_EQ(result.fields[0].max, 8);
    EXPECT_EQ(result.fields[1].min, 50);
    EXPECT_EQ(result.fields[1].max, 50);
}

TEST(Assemble, CellsOfDifferentKindsFitTogether) {
    const ReadResult result = assembled(cube_with_neighbours());
    EXPECT_NEAR(volume_of(result.mesh), 1 + 0.5 / 3 + 0.5, kRounding);
    EXPECT_GT(least_volume(result.mesh), 0);
    const double of_cube = 4, of_pyramid = 4 * 0.5 * std::sqrt(0.5), of_prism = 2 * 0.5 + 1 + std::sqrt(2);
    EXPECT_NEAR(open_area(result.mesh), of_cube + of_pyramid + of_prism, 1e-12);
    EXPECT_THAT(result.warnings,
                Contains(HasSubstr("1 hexahedron, 1 prism and 1 pyramid cut into 11 tetrahedra and split into 44 hexahedra")))
        << "6, 3 and 2 tetrahedra of 4 hexahedra each";
}

TEST(Assemble, EveryChildHasTheNumberOfItsCell) {
    MeshFile file = cube_with_neighbours();
    add_at_cells(file, "T", {1, 3, 5});  // of the cube, the pyramid and the prism, in the order of the file
    const ReadResult result = assembled(file, {.cell_values = CellValues::Fit});
    ASSERT_EQ(result.cell_parts.size(), result.mesh.cells.size());
    ASSERT_EQ(result.cell_means.size(), 1U);
    std::array<double, 3> volumes{};
    for (std::size_t c = 0; c < result.cell_parts.size(); ++c) {
        volumes[result.cell_parts[c]] += cell_volume(test::corners_of(result.mesh, c));
        EXPECT_EQ(result.cell_means[0].values[c], 1 + 2 * result.cell_parts[c]);
    }
    EXPECT_NEAR(volumes[0], 1, kRounding);
    EXPECT_NEAR(volumes[1], 0.5 / 3, kRounding);
    EXPECT_NEAR(volumes[2], 0.5, kRounding);
}

TEST(Assemble, OtherCellsAreRefusedIfTheyAreNotAllowed) {
    EXPECT_EQ(refusal_of(cube_with_neighbours(), {.other_cells = OtherCells::Refuse}),
              "made.file: the mesh has 1 hexahedron, 1 prism and 1 pyramid (only hexahedra are allowed)");
}

TEST(Assemble, CellsWithTheSameCornersAreRefused) {
    MeshFile file = kinds().front().file;
    add_cell(file, file.tets, {3, 0, 1, 2});
    EXPECT_THAT(refusal_of(file), testing::StartsWith("made.file: "));
    EXPECT_THAT(refusal_of(file), HasSubstr("points 0 1 2 3"));
    EXPECT_THAT(refusal_of(MeshFile{}), HasSubstr("made.file: the mesh has no hexahedra"));
}

TEST(Assemble, ArraysOfAnotherLengthAreRefused) {
    MeshFile file = file_of(make_box(1, 1, 1));
    file.arrays.push_back({"p", 3, false, std::vector<double>(27, 1.0)});
    EXPECT_THAT(refusal_of(file), testing::AllOf(HasSubstr("made.file: "), HasSubstr("\"p\""), HasSubstr("27 values"),
                                                 HasSubstr("8 points of 3 channels")));
}

TEST(Assemble, LeftHandedCellsAreTurnedUnlessTheFileMeansThem) {
    MeshFile file = file_of(make_box(3, 1, 1));
    auto& [a, b, c, d, e, f, g, h] = file.hexes.corners[1];
    for (auto [lower, upper] : {std::pair(&a, &e), std::pair(&b, &f), std::pair(&c, &g), std::pair(&d, &h)})
        std::swap(*lower, *upper);
    const ReadResult result = assembled(file);
    EXPECT_EQ(volume_of(result.mesh), 3);
    EXPECT_EQ(least_volume(result.mesh), 1);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("1 of 3 hexahedra was left-handed")));
    file.turned = true;
    const ReadResult kept = assembled(file);
    EXPECT_EQ(least_volume(kept.mesh), -1);
    EXPECT_THAT(kept.warnings, ElementsAre("1 of 3 hexahedra has a negative Jacobian at a corner"));
}

/// The unit cube with its last corner moved to (a, a, a): the triple product of the edges there is 3 a - 2, at its neighbours
/// a.
TEST(Assemble, AFoldIsANegativeJacobianAtACorner) {
    auto corners = test::corners_of(make_box(1, 1, 1), 0);
    for (const auto& [a, folded] : {std::pair{1.0, false}, {0.67, false}, {0.66, true}, {-0.1, true}, {5.0, false}}) {
        corners[6] = Vec3(a);
        EXPECT_EQ(is_folded(corners), folded) << a;
    }
}

TEST(Assemble, PointsThatAreNotFiniteMatterOnlyWhereACellUsesThem) {
    MeshFile file = file_of(make_box(1, 1, 1));
    const std::string text = "first\nsecond\nthird\n";
    const TextScanner in(text, "a.txt", TextScanner::Comments::None);
    add_point(file, {0, kNan, 0}, 7);  // in the second line
    const ReadResult result = assemble(MeshFile(file), in, "a.txt", kMadeNames, {});
    EXPECT_EQ(volume_of(result.mesh), 1);
    file.hexes.corners[0][6] = 8;
    EXPECT_EQ(test::error_of([&] { static_cast<void>(assemble(MeshFile(file), in, "a.txt", kMadeNames, {})); }),
              "a.txt, line 2: non-finite coordinate at point 8");
}

/// A row of cells of the lengths 1, 2 and 3.
MeshFile row() {
    HexMesh mesh = make_box(3, 1, 1);
    for (Vec3& x : mesh.points) x.x = x.x * (x.x + 1) / 2;
    return file_of(mesh);
}

TEST(Assemble, ValuesAtCellsBecomeMeansByVolume) {
    MeshFile file = row();
    add_at_cells(file, "T", {6, 3, 0.5});
    file.arrays.push_back({"U", 2, true, {1, -1, 4, -4, 2, -2}});
    const ReadResult result = assembled(file);
    const auto& T = result.mesh.find_attribute("T")->values;
    const auto& U = result.mesh.find_attribute("U")->values;
    const std::array<double, 4> expected_T{6, (6 + 2 * 3) / 3., (2 * 3 + 3 * 0.5) / 5, 0.5};
    const std::array<double, 4> expected_U{1, (1 + 2 * 4) / 3., (2 * 4 + 3 * 2) / 5., 2};
    for (std::size_t p = 0; p < result.mesh.points.size(); ++p) {  // point i + 4 (j + 2 k)
        EXPECT_NEAR(T[p], expected_T[p % 4], kRounding);
        EXPECT_NEAR(U[2 * p], expected_U[p % 4], kRounding);
        EXPECT_NEAR(U[2 * p + 1], -expected_U[p % 4], kRounding);
    }
    EXPECT_THAT(result.mesh.find_attribute("T")->cells, ElementsAre(6, 3, 0.5));
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("2 cell arrays became point arrays (\"T\", \"U\")")));
}

/// A collapsed cell without volume beside no other cell: the plain mean.
TEST(Assemble, CellsWithoutVolumeHaveThePlainMean) {
    MeshFile file = file_of(make_box(2, 1, 1));
    for (Vec3& x : file.points) x.z = 0;
    add_at_cells(file, "T", {1.5, 4.5});
    const ReadResult result = assembled(file);
    EXPECT_EQ(value_at(result.mesh, "T", {0, 0, 0}), 1.5);
    EXPECT_EQ(value_at(result.mesh, "T", {1, 0, 0}), 3);
}

TEST(Assemble, LabelsOfCellsStayConstant) {
    struct Case {
        std::string name;
        std::vector<double> values;
        bool integers, constant;
    };
    for (const Case& one : {Case{"Material", {1, 2, 2}, false, true}, Case{"T", {1, 2, 2}, false, false},
                            Case{"T", {1, 2, 2}, true, true}, Case{"block_id", {1, 2, 2.5}, true, false},
                            Case{"region", {7, 7, 7}, true, false}, Case{"cellIds", {3, 1, 2}, false, true},
                            Case{"fluids", {3, 1, 2}, false, true}, Case{"humid", {3, 1, 2}, false, false}}) {
        MeshFile file = row();
        file.arrays.push_back({one.name, 1, true, one.values, {}, {}, one.integers});
        const ReadResult result = assembled(file);
        EXPECT_EQ(result.mesh.attributes[0].constant, one.constant) << one.name;
        EXPECT_THAT(result.warnings, ElementsAre(HasSubstr(one.constant ? "whole numbers" : "became a point array")));
        EXPECT_FALSE(assembled(file, {.cell_values = CellValues::Mean}).mesh.attributes[0].constant) << one.name;
        EXPECT_TRUE(assembled(file, {.cell_values = CellValues::Constant}).mesh.attributes[0].constant) << one.name;
    }
}

TEST(Assemble, LabelsAtPointsGiveEachCellTheNumberOfMostOfItsPoints) {
    MeshFile file = file_of(make_box(4, 3, 3));
    std::mt19937 random(3);
    std::uniform_int_distribution<int> label(1, 4);
    add_at_points(file, "MaterialIds", [&](const Vec3&) { return label(random); });
    const ReadResult result = assembled(file);
    const Attribute& found = result.mesh.attributes[0];
    ASSERT_TRUE(found.constant);
    for (std::size_t c = 0; c < result.mesh.cells.size(); ++c) {
        std::array<int, 5> votes{};
        for (const Index p : result.mesh.cells[c]) ++votes[static_cast<std::size_t>(file.arrays[0].values[p])];
        const auto most = static_cast<std::size_t>(std::ranges::max_element(votes) - votes.begin());  // the least of as many
        EXPECT_EQ(found.cells[c], static_cast<double>(most)) << c;
    }
    for (const std::string name : {"GlobalNodeId", "PointIds", "grey", "id"}) {
        file.arrays[0].name = name;
        EXPECT_FALSE(assembled(file).mesh.attributes[0].constant) << name << " numbers no parts";
    }
}

TEST(Assemble, FieldsWithAGapAreThoseOfTheCellsThatHaveThem) {
    MeshFile file = file_of(make_box(3, 1, 1));
    file.points.emplace_back(9, 9, 9);  // no cell uses it
    add_at_points(file, "whole", [](const Vec3& x) { return x.x == 9 ? kNan : x.x; });
    add_at_points(file, "gap", [](const Vec3& x) { return x.x == 3 && x.y == 0 ? kNan : x.x; });
    add_at_points(file, "few", [](const Vec3& x) { return x.x == 1 || x.x == 2 ? HUGE_VAL : x.x; });
    add_at_points(file, "none", [](const Vec3&) { return kNan; });
    add_at_cells(file, "cells", {0.5, kNan, 2});
    ReadResult result = assembled(file);
    ASSERT_EQ(result.mesh.attributes.size(), 1U);
    EXPECT_EQ(result.mesh.attributes[0].name, "whole");
    ASSERT_EQ(result.unread.size(), 1U);
    EXPECT_EQ(result.unread[0].name + ": " + result.unread[0].why, "none: the value at point 0 is not finite");
    std::vector<std::string> found;
    for (const FieldInfo& field : result.fields)
        found.push_back(field.name + " " + std::to_string(field.missing) + " " + std::to_string(static_cast<int>(field.max)));
    EXPECT_THAT(found, ElementsAre("whole 0 3", "gap 2 3", "few 8 3", "cells 1 2"));
    ASSERT_EQ(result.incomplete.size(), 3U);
    const auto missing = [&](const std::vector<double>& values) {
        return std::ranges::count_if(values, [](double value) { return std::isnan(value); });
    };
    EXPECT_EQ(missing(result.incomplete[0].values), 2);
    EXPECT_EQ(missing(result.incomplete[1].values), 8) << "what is infinite is not there";
    EXPECT_EQ(missing(result.incomplete[2].cells), 1);
    EXPECT_EQ(missing(result.incomplete[2].values), 0) << "at each point the mean of the cells that have a value";
    for (std::size_t p = 0; p < 16; ++p) {
        const double x = result.mesh.points[p].x;
        EXPECT_EQ(result.incomplete[2].values[p], x <= 1 ? 0.5 : 2);
    }
    EXPECT_THAT(
        result.warnings,
        ElementsAre("field \"none\" left out: the value at point 0 is not finite",
                    "3 fields (\"gap\", \"few\", \"cells\") are not everywhere; the first has no value at 2 of 16 points: "
                    "asked for by its name, it is that of the 2 of 3 cells that have it; otherwise it is left out"));
    std::erase_if(file.arrays, [](const FileArray& array) { return array.name != "none"; });
    EXPECT_EQ(assembled(file).mesh.cells.size(), 3U) << "a mesh without fields is one";
}

TEST(Assemble, FieldsHaveTheRangeOfTheirLengths) {
    MeshFile file = file_of(make_box(1, 1, 1));
    FileArray velocity{"U", 3, false, {}, "m/s"};
    for (int p = 0; p < 8; ++p) velocity.values.insert(velocity.values.end(), {2. * p, 3. * p, 6. * p});
    file.arrays.push_back(velocity);
    add_at_points(file, "density", [](const Vec3& x) { return x.x - 0.5; });
    const ReadResult result = assembled(file);
    EXPECT_EQ(result.fields[0].min, 0);
    EXPECT_EQ(result.fields[0].max, 49) << "7 (2, 3, 6)";
    EXPECT_EQ(result.fields[0].unit, "m/s");
    EXPECT_EQ(result.fields[0].location, "point");
    EXPECT_EQ(result.fields[1].min, -0.5);
    EXPECT_THAT(result.warnings, ElementsAre("\"density\" has negative values"));
}

TEST(Assemble, FieldsOfOneNameAreAllKept) {
    MeshFile file = file_of(make_box(1, 1, 1));
    for (const double value : {1., 2., 3.}) add_at_points(file, "T", [=](const Vec3&) { return value; });
    add_at_points(file, "", [](const Vec3&) { return 4; });
    const ReadResult result = assembled(file);
    std::vector<std::string> names;
    for (const Attribute& attribute : result.mesh.attributes) {
        names.push_back(attribute.name);
        EXPECT_THAT(attribute.values, Each(static_cast<double>(names.size())));
    }
    EXPECT_THAT(names, ElementsAre("T", "T_2", "T_3", "unnamed"));
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("more than one array \"T\": 2 others are called \"T_2\" to \"T_3\"")));
}

/// Three columns of two cells each, in the shape of an L: the re-entrant edge at x = y = 1 bends by 90 degrees.
MeshFile angle() {
    HexMesh mesh = make_box(2, 2, 2);
    std::erase_if(mesh.cells, [&](const auto& cell) { return mesh.points[cell[0]].x == 1 && mesh.points[cell[0]].y == 1; });
    return file_of(mesh);
}

double length_of_creases(const HexMesh& mesh, double at) {
    double length = 0;
    for (const auto& [a, b] : mesh.creases) {
        for (const Index p : {a, b}) EXPECT_TRUE(mesh.points[p].x == at && mesh.points[p].y == at) << p;
        length += glm::distance(mesh.points[a], mesh.points[b]);
    }
    return length;
}

TEST(Assemble, EdgesThatBendAreKeptSharpAlsoWhereCellsAreSplit) {
    MeshFile file = angle();
    const ReadResult result = assembled(file);
    EXPECT_EQ(length_of_creases(result.mesh, 1), 2);
    ASSERT_TRUE(result.sharp_edges);
    EXPECT_EQ(result.sharp_edges->edges, 2U);
    EXPECT_THAT(assembled(file, {.crease_angle_deg = 0}).mesh.creases, ElementsAre());
    EXPECT_THAT(assembled(file, {.crease_angle_deg = 91}).mesh.creases, ElementsAre());
    FileTags settled;
    settled.settled = true;
    file.sharp = settled;
    EXPECT_THAT(assembled(file).mesh.creases, ElementsAre()) << "the file says that there are none";
    file.sharp = {};
    // A tetrahedron that touches no other cell: all hexahedra are split, and the creases with them.
    const auto first = static_cast<Index>(file.points.size());
    file.points.insert(file.points.end(), {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}});
    add_cell(file, file.tets, {first, first + 1, first + 2, first + 3});
    const ReadResult split = assembled(file);
    EXPECT_EQ(split.mesh.creases.size(), 4U);
    EXPECT_EQ(length_of_creases(split.mesh, 1), 2);
}

TEST(Assemble, GhostsAndHiddenPointsLeaveCellsOut) {
    for (const auto& [flag, left] :
         {std::pair{kDuplicateCell, 2.}, {kRefinedCell, 2.}, {kHiddenCell + 2, 2.}, {4U, 3.}, {0U, 3.}}) {
        MeshFile file = file_of(make_box(3, 1, 1));
        add_at_cells(file, std::string(kGhostArray), {0, static_cast<double>(flag), 0});
        add_at_cells(file, "T", {0.5, kNan, 1.5});
        const std::size_t fields = left == 3 ? 0 : 1;
        if (fields == 0) add_at_points(file, "x", [](const Vec3& x) { return x.x; });
        const ReadResult result = assembled(file);
        EXPECT_EQ(volume_of(result.mesh), left) << flag;
        EXPECT_EQ(result.incomplete.size(), 1 - fields) << "what a ghost has does not matter";
        EXPECT_EQ(result.mesh.find_attribute(kGhostArray), nullptr);
    }
    MeshFile file = file_of(make_box(3, 1, 1));
    add_at_points(file, std::string(kGhostArray), [](const Vec3& x) { return x == Vec3(3, 1, 1) ? kHiddenPoint : 1; });
    EXPECT_EQ(volume_of(assembled(file).mesh), 2);
}

TEST(Assemble, OlderGhostLevelsAreGhosts) {
    MeshFile file = file_of(make_box(3, 1, 1));
    add_at_cells(file, "vtkGhostLevels", {0, 1, 2});
    take_ghost_levels(file);
    EXPECT_EQ(volume_of(assembled(file).mesh), 1);
    MeshFile both = file_of(make_box(3, 1, 1));
    add_at_cells(both, "vtkGhostLevels", {0, 1, 2});
    add_at_cells(both, std::string(kGhostArray), {0, 1, 0});
    take_ghost_levels(both);
    EXPECT_EQ(volume_of(assembled(both).mesh), 2) << "the newer array counts";
    EXPECT_FALSE(leaves_out_cell(kNan) || leaves_out_cell(256 + 1) || leaves_out_cell(-1) || hides_point(1));
}

/// A cube and two quads beside it that share an edge; the first one hangs on the cube.
MeshFile cube_with_shells() {
    MeshFile file = file_of(make_box(1, 1, 1));
    file.points.insert(file.points.end(), {{2, 0, 0}, {2, 1, 0}, {3, 0, 0}, {3, 1, 0}, {4, 0, 0}});
    add_cell(file, file.quads, {1, 8, 9, 3});
    add_cell(file, file.quads, {8, 10, 11, 9});
    add_cell(file, file.lines, {10, 12});
    return file;
}

TEST(Assemble, ValuesAtShellsAreMeansOverThem) {
    MeshFile file = cube_with_shells();
    add_at_cells(file, "T", {5.5, 1, 3, 7});
    const ReadResult result = assembled(file);
    ASSERT_EQ(result.shells.quads.size(), 2U);
    ASSERT_EQ(result.shells.lines.size(), 1U);
    const std::map<double, double> expected{{1, 5.5}, {2, 2}, {4, 7}};  // by x; of x = 3 below
    for (std::size_t p = 0; p < result.shells.points.size(); ++p) {
        const Vec3 x = result.shells.points[p];
        const double value = x.x == 3 ? (x.y == 0 ? (3 + 7) / 2. : 3) : expected.at(x.x);
        EXPECT_EQ(result.shells.attributes[0].values[p], value) << x.x << ", " << x.y;
    }
    EXPECT_EQ(result.mesh.cells.size(), 1U);
}

TEST(Assemble, ShellsThatCannotBeUsedAreLeftOut) {
    MeshFile file = cube_with_shells();
    file.quads.corners[1][2] = 10;  // twice
    const ReadResult result = assembled(file);
    EXPECT_EQ(result.shells.quads.size(), 1U);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("1 quad ignored: they repeat a point")));
    file.points.emplace_back(0, 0, -1);
    add_cell(file, file.tets, {0, 1, 2, 13});
    const ReadResult split = assembled(file);
    EXPECT_TRUE(split.shells.empty());
    EXPECT_THAT(split.warnings, Contains(HasSubstr("2 quads and 1 line ignored: shells and beams are read beside hexahedra")));
    EXPECT_THAT(split.warnings, Not(Contains(HasSubstr("repeat a point"))));
    MeshFile alone = cube_with_shells();
    alone.hexes = {};
    EXPECT_THAT(refusal_of(alone), HasSubstr("no hexahedra"));
    EXPECT_EQ(assembled(alone, {.shells_alone = true}).shells.quads.size(), 2U);
}

}  // namespace assemble_test
}  // namespace subvol::detail
