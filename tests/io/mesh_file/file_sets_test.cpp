// SPDX-License-Identifier: Apache-2.0
// Patches, sets and blocks of a file as those of the mesh, and groups of faces and edges that stay sharp.
#include "file_sets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "made_files.h"
#include "mesh_arrays.h"
#include "sharp_groups.h"
#include "subvol/cell.h"
#include "subvol/mesh_sets.h"

namespace subvol::detail {
namespace file_sets_test {

using test::add_at_cells;
using test::add_cell;
using test::assembled;
using test::error_of;
using test::file_of;
using test::make_box;
using test::refusal_of;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kRounding = 1e-13;

/// A face of a box of cells by the place of its first corner: of size 1, across an axis.
std::array<Index, 4> face_at(const MeshFile& file, const Vec3& lower, int axis) {
    Vec3 along(0), up(0);
    along[(axis + 1) % 3] = 1;
    up[(axis + 2) % 3] = 1;
    const auto point = [&](const Vec3& x) {
        return static_cast<Index>(std::ranges::find(file.points, x) - file.points.begin());
    };
    return {point(lower), point(lower + along), point(lower + along + up), point(lower + up)};
}

double area_of_patch(const HexMesh& mesh, const Patch& patch) {
    double area = 0;
    for (const auto& [cell, side] : patch.sides) area += test::area_of(mesh, test::side_of(mesh, cell, side));
    return area;
}

/// Two cells along x with a prism on the second one, and patches: one at the bottom, one around the top, one between cells.
MeshFile house(bool with_roof) {
    MeshFile file = file_of(make_box(2, 1, 1));
    file.patches = {{.name = "bottom"}, {.name = "top"}, {.name = "between"}, {.name = "both"}};
    file.patches[0].add(face_at(file, {0, 0, 0}, 2));
    file.patches[0].add(face_at(file, {1, 0, 0}, 2));
    file.patches[1].add(face_at(file, {0, 0, 1}, 2));
    file.patches[2].add(face_at(file, {1, 0, 0}, 0));
    file.patches[3].add(face_at(file, {0, 0, 0}, 0));
    file.patches[3].add(face_at(file, {0, 0, 0}, 2));
    if (!with_roof) return file;
    const auto top = face_at(file, {1, 0, 1}, 2);
    const auto ridge = static_cast<Index>(file.points.size());
    file.points.insert(file.points.end(), {{1.5, 0, 2}, {1.5, 1, 2}});
    add_cell(file, file.prisms, {top[0], top[1], ridge, top[3], top[2], ridge + 1});
    file.patches[1].add(std::array{top[0], ridge, ridge + 1, top[3]});
    file.patches[1].add(std::array{top[1], ridge, ridge + 1, top[2]});
    file.patches[1].add(std::array{top[0], top[1], ridge});
    file.patches[1].add(top);  // now inside
    return file;
}

TEST(FileSets, PatchesKeepTheirAreaWhereCellsAreSplit) {
    for (const bool with_roof : {false, true}) {
        for (const bool with_pyramid : {false, true}) {  // a pyramid apart from all: all cells are cut into tetrahedra
            MeshFile file = house(with_roof);
            const auto first = static_cast<Index>(file.points.size());
            if (with_pyramid) {
                file.points.insert(file.points.end(), {{5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0}, {5, 0, 1}});
                add_cell(file, file.pyramids, {first, first + 1, first + 2, first + 3, first + 4});
            }
            const ReadResult result = assembled(file);
            const auto area = [&](const std::string& name) {
                return area_of_patch(result.mesh, find_patch(result.sets, name));
            };
            EXPECT_NEAR(area("bottom"), 2, kRounding);
            EXPECT_NEAR(area("top"), with_roof ? 1 + std::sqrt(5) + 0.5 : 1, kRounding);
            EXPECT_NEAR(area("both"), 2, kRounding);
            EXPECT_EQ(result.sets.patches.size(), 3U);
            EXPECT_THAT(result.warnings, Contains("patch \"between\" left out: its faces lie between cells"));
            validate(result.sets, result.mesh);
            for (const auto& [cell, side] : find_patch(result.sets, "bottom").sides) {
                for (const Index p : test::side_of(result.mesh, cell, side)) EXPECT_EQ(result.mesh.points[p].z, 0);
            }
        }
    }
}

TEST(FileSets, PatchesOfFacesThatNoCellHasAreEmpty) {
    MeshFile file = file_of(make_box(2, 1, 1));
    file.points.emplace_back(9, 9, 9);
    file.patches = {{.name = "across"}, {.name = "elsewhere"}, {.name = "triangle"}};
    file.patches[0].add(std::array<Index, 4>{0, 1, 11, 10});  // cuts through a cell
    file.patches[1].add(std::array<Index, 4>{0, 1, 4, 12});
    file.patches[2].add(std::array<Index, 3>{0, 1, 4});
    EXPECT_TRUE(assembled(file).sets.patches.empty());
}

TEST(FileSets, SetsHaveAllPartsOfTheirCells) {
    MeshFile file = house(true);
    file.sets = {{"second", {2, 1, 1}}, {"first", {0}}, {"none", {17}}};
    const ReadResult result = assembled(file);
    double volume = 0;
    for (const Index c : find_set(result.sets, "second").cells) {
        volume += cell_volume(test::corners_of(result.mesh, c));
        EXPECT_GE(test::mean_at(result.mesh.points, result.mesh.cells[c]).x, 1);
    }
    EXPECT_NEAR(volume, 1 + 0.5, kRounding) << "a cell and the roof";
    EXPECT_EQ(find_set(result.sets, "first").cells.size(), 8U);
    EXPECT_EQ(result.sets.sets.size(), 2U);
    validate(result.sets, result.mesh);
}

TEST(FileSets, ValuesOnPatchesStayWithTheirFaces) {
    MeshFile file = house(true);
    file.patches[0].role = PatchRole::Wall;
    FileArray U{"U", 2, true, {0, 0, 1, 1, 2, 2}};
    U.on_patches = {{.patch = 0, .along = true, .values = {1, -1, 2, -2}},
                    {.patch = 1, .values = {3, -3}, .level = true},
                    {.patch = 3, .values = {9, 9, 9, 9, 9, 9}}};  // one face more than the patch has
    file.arrays = {U};
    const ReadResult result = assembled(file, {.cell_values = CellValues::Mean});
    const ValuesOnPatches& on = result.on_patches;
    ASSERT_EQ(on.patches.size(), 2U + 5 + 1 + 2);
    ASSERT_EQ(on.fields.size(), 1U);
    EXPECT_EQ(on.roles[1], PatchRole::Wall);
    EXPECT_EQ(on.roles[2], PatchRole::Open);
    EXPECT_EQ(on.fields[0].along[0], 1);
    EXPECT_EQ(on.fields[0].along[2], 0);
    EXPECT_TRUE(on.fields[0].is_level(2));
    double area = 0;
    for (const auto& [side, face] : on.sides) {
        const auto quad = test::side_of(result.mesh, side.cell, side.side);
        const Vec3 middle = test::mean_at(result.mesh.points, quad);
        if (middle.z == 0) {
            EXPECT_EQ(on.fields[0].values[2 * face], middle.x < 1 ? 1 : 2) << middle.x;
            EXPECT_EQ(on.fields[0].values[2 * face + 1], middle.x < 1 ? -1 : -2) << middle.x;
            area += test::area_of(result.mesh, quad);
        } else if (middle.z == 1 && middle.x < 1) {
            EXPECT_EQ(on.fields[0].values[2 * face], 3);
        } else {
            EXPECT_TRUE(std::isnan(on.fields[0].values[2 * face])) << "the file has no value there";
        }
    }
    EXPECT_NEAR(area, 2, kRounding);
    ASSERT_EQ(result.cell_parts.size(), result.mesh.cells.size());
}

TEST(FileSets, SetsOfArraysAreTheCellsWithOtherValuesThanZero) {
    MeshFile file = file_of(make_box(4, 1, 1));
    add_at_cells(file, "set:a", {0, 1, std::nan(""), -2});
    add_at_cells(file, "set:", {1, 1, 1, 1});  // no name: a field
    add_at_cells(file, "set:a", {1, 0, 0, 0});
    file.arrays.push_back({"set:b", 2, true, std::vector<double>(8)});
    take_set_arrays(file);
    ASSERT_EQ(file.sets.size(), 1U);
    EXPECT_EQ(file.sets[0].name, "a");
    EXPECT_THAT(file.sets[0].numbers, ElementsAre(1, 3, 0));
    ASSERT_EQ(file.arrays.size(), 2U);
    EXPECT_EQ(file.arrays[0].name, "set:");
    EXPECT_EQ(set_array_name({"a", {}}), "set:a");
}

/// A mesh with a crease, a sharp face and two patches, and the file that has the same points and cells.
struct Tagged {
    HexMesh mesh = make_box(2, 1, 1);
    MeshSets sets{{{"in", {{0, 0}}}, {"none", {}}, {"walls", {{1, 1}, {0, 4}}}}, {}};
    MeshFile file = file_of(mesh);

    Tagged() {
        mesh.creases = {{0, 1}};
        mesh.sharp_faces = {{1, 4, 10, 7}};
    }
};

TEST(FieldArrays, GiveBackWhatTheyWereMadeOf) {
    Tagged tagged;
    const auto arrays = field_arrays(tagged.mesh, tagged.sets);
    for (const NamedNumbers& array : arrays) EXPECT_TRUE(is_field_array(array.name)) << array.name;
    take_field_arrays(arrays, tagged.file);
    EXPECT_TRUE(tagged.file.sharp.settled);
    const ReadResult result = assembled(tagged.file);
    EXPECT_EQ(result.mesh.creases, tagged.mesh.creases);
    ASSERT_EQ(result.mesh.sharp_faces.size(), 1U);
    EXPECT_EQ(std::set<Index>(result.mesh.sharp_faces[0].begin(), result.mesh.sharp_faces[0].end()),
              (std::set<Index>{1, 4, 7, 10}));
    EXPECT_EQ(find_patch(result.sets, "in").sides, tagged.sets.patches[0].sides);
    EXPECT_THAT(find_patch(result.sets, "walls").sides, ElementsAre(CellSide{0, 4}, CellSide{1, 1}));
    EXPECT_EQ(result.sets.patches.size(), 2U);
    EXPECT_FALSE(is_field_array("patch") || is_field_array("set:a") || is_field_array("patch:"));
    // Without creases the file says so, and nobody looks for sharp edges.
    HexMesh smooth = make_box(2, 1, 1);
    MeshFile file = file_of(smooth);
    EXPECT_TRUE(field_arrays(smooth, {}).empty());
    take_field_arrays(settled_arrays(smooth, {}), file);
    EXPECT_TRUE(file.sharp.settled && file.sharp.empty());
}

TEST(FieldArrays, OfAnotherMeshOrDamagedAreIgnored) {
    struct Damage {
        std::string what;
        std::function<void(std::vector<std::int64_t>&)> to;
        std::string said;
    };
    const std::vector<Damage> all{
        {"points", [](auto& numbers) { ++numbers[0]; }, "it is of another mesh"},
        {"cells", [](auto& numbers) { --numbers[1]; }, "it is of another mesh"},
        {"corners", [](auto& numbers) { numbers[2] ^= 1; }, "it is of another mesh"},
        {"no mark", [](auto& numbers) { numbers.resize(2); }, "it is of another mesh"},
        {"point 12 of 12", [](auto& numbers) { numbers.back() = 12; }, "it names a point that does not exist"},
        {"point -1", [](auto& numbers) { numbers.back() = -1; }, "it names a point that does not exist"},
        {"length", [](auto& numbers) { numbers.push_back(0); }, "it has the wrong length"}};
    for (const Damage& damage : all) {
        Tagged tagged;
        auto arrays = field_arrays(tagged.mesh, tagged.sets);
        ASSERT_EQ(arrays.size(), 3U);
        for (NamedNumbers& array : arrays) damage.to(array.numbers);
        take_field_arrays(arrays, tagged.file);
        EXPECT_TRUE(tagged.file.sharp.empty() && !tagged.file.sharp.settled && tagged.file.patches.empty()) << damage.what;
        EXPECT_THAT(tagged.file.warnings,
                    ElementsAre("array of creases and sharp faces \"SubvolSharp\" ignored: " + damage.said,
                                "2 patches left out (\"in\", \"walls\"): " + damage.said))
            << damage.what;
    }
    for (const std::int64_t creases : {std::int64_t{-1}, std::int64_t{4}, std::int64_t{1} << 62}) {
        Tagged tagged;
        auto arrays = field_arrays(tagged.mesh, {});
        arrays[0].numbers[3] = creases;
        take_field_arrays(arrays, tagged.file);
        EXPECT_THAT(tagged.file.warnings, ElementsAre(HasSubstr("it has the wrong length"))) << creases;
    }
    Tagged tagged;
    auto arrays = field_arrays(tagged.mesh, tagged.sets);
    std::swap(arrays[1].numbers[4], arrays[1].numbers.back());  // still a face, of other corners
    arrays[1].numbers[3] = 11;
    take_field_arrays(arrays, tagged.file);
    EXPECT_THAT(tagged.file.warnings, ElementsAre(HasSubstr("patch \"in\"")));
}

TEST(SharpTags, AreSplitWithTheirCells) {
    for (const bool with_tet : {false, true}) {
        MeshFile file = file_of(make_box(2, 1, 1));
        if (with_tet) {
            file.points.insert(file.points.end(), {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}});
            add_cell(file, file.tets, {12, 13, 14, 15});
        }
        file.sharp.faces = {{1, 4, 10, 7}, {0, 3, 9, 6}};  // between the cells, and on the hull
        file.sharp.edges = {{0, 1}, {1, 0}, {4, 10}};
        const ReadResult result = assembled(file);
        double area = 0, length = 0;
        for (const auto& face : result.mesh.sharp_faces) {
            for (const Index p : face) EXPECT_EQ(result.mesh.points[p].x, 1);
            area += test::area_of(result.mesh, face);
        }
        for (const auto& [a, b] : result.mesh.creases) length += glm::distance(result.mesh.points[a], result.mesh.points[b]);
        EXPECT_NEAR(area, 1, kRounding);
        EXPECT_NEAR(length, 2, kRounding) << "an edge of the hull once, and one of the sharp face";
        EXPECT_EQ(result.mesh.sharp_faces.size(), with_tet ? 4U : 1U);
    }
}

TEST(SharpTags, OfOtherThanFacesAndEdgesAreRefused) {
    const auto with = [](std::array<Index, 4> face, std::array<Index, 2> edge) {
        MeshFile file = file_of(make_box(2, 2, 2));  // point i + 3 (j + 3 k); 13 is inside
        file.sharp.faces = {face};
        file.sharp.edges = {edge};
        return refusal_of(file);
    };
    constexpr std::array<Index, 4> kInside{4, 5, 14, 13};
    constexpr std::array<Index, 2> kEdge{0, 1};
    EXPECT_EQ(with(kInside, kEdge), "no error");
    EXPECT_EQ(with({4, 5, 14, 16}, kEdge),
              "made.file: point 4, point 5, point 14, point 16: they are not a face of a cell (groups of faces between cells)");
    EXPECT_THAT(with({4, 5, 14, 14}, kEdge), HasSubstr("point 4, point 5, point 14: they are not a face of a cell"));
    EXPECT_THAT(with(kInside, {0, 4}), HasSubstr("point 0, point 4: they are not an edge of a cell"));
    EXPECT_THAT(with(kInside, {13, 16}), HasSubstr("point 13, point 16: the edge lies inside the mesh"));
    EXPECT_EQ(with(kInside, {13, 14}), "no error") << "it is an edge of the sharp face";
}

/// The points of a mesh for which in(place) is true.
template <class In>
std::vector<Index> points_where(const HexMesh& mesh, const In& in) {
    std::vector<Index> points;
    const std::vector<std::uint8_t> used = used_points(file_of(mesh));
    for (Index p = 0; p < mesh.points.size(); ++p) {
        if (used[p] && in(mesh.points[p])) points.push_back(p);
    }
    return points;
}

TEST(FileSets, PointsBetweenNodesOfASetBelongToIt) {
    const auto on_floor = [](const Vec3& x) { return x.z == 0; };
    const auto on_edge = [](const Vec3& x) { return x.z == 0 && x.y == 0 && x.x <= 1; };
    for (const bool with_roof : {false, true}) {  // with it all cells are split
        MeshFile file = house(with_roof);
        file.node_sets = {{"floor", {}}, {"edge", {}}, {"loose", {}}, {"empty", {}}, {"all", {}}};
        const auto loose = static_cast<Index>(file.points.size());
        file.points.emplace_back(9, 9, 9);
        for (Index p = 0; p < loose; ++p) {
            if (on_floor(file.points[p])) file.node_sets[0].numbers.insert(file.node_sets[0].numbers.end(), {p, p});
            if (on_edge(file.points[p])) file.node_sets[1].numbers.push_back(p);
            file.node_sets[4].numbers.push_back(p);
        }
        file.node_sets[2].numbers = {loose};
        const ReadResult result = assembled(file);
        const HexMesh& mesh = result.mesh;
        ASSERT_EQ(result.sets.nodes.size(), 3U);
        EXPECT_THAT(
            result.warnings,
            Contains(HasSubstr("2 sets of nodes left out (\"loose\", \"empty\"): no node of it is a corner of a cell")));
        validate(result.sets, mesh);
        EXPECT_EQ(points_of(mesh, result.sets.nodes[0]), points_where(mesh, on_floor));
        EXPECT_EQ(points_of(mesh, result.sets.nodes[1]), points_where(mesh, on_edge));
        EXPECT_EQ(points_of(mesh, result.sets.nodes[2]), points_where(mesh, [](const Vec3&) { return true; }));
        EXPECT_NEAR(area_of_patch(mesh, boundary_of(mesh, result.sets.nodes[0])), 2, kRounding);
        EXPECT_TRUE(boundary_of(mesh, result.sets.nodes[1]).sides.empty());
        EXPECT_EQ(chosen_patches(mesh, result.sets, std::vector<std::string>{"nodes:floor"})[0].sides.size(),
                  boundary_of(mesh, result.sets.nodes[0]).sides.size());
        // Children are parts of half the size: both rules agree.
        std::vector<PartOfCell> halves;
        for (Index c = 0; c < 8 * mesh.cells.size(); ++c) {
            Vec3 lower;
            for (int a = 0; a < 3; ++a) lower[a] = .5 * kCornerParameters[c % 8][static_cast<std::size_t>(a)];
            halves.push_back({c / 8, lower, Vec3(.5)});
        }
        const MeshSets children = sets_of_children(result.sets, 1), parts = sets_of_parts(result.sets, halves);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(children.nodes[k].cells, parts.nodes[k].cells);
        EXPECT_EQ(children.nodes[2].cells.size(), 8 * mesh.cells.size());
    }
}

TEST(FileSets, WrongSetsOfNodesAreRefused) {
    const HexMesh mesh = make_box(2, 1, 1);
    const auto refused = [&](const MeshSets& sets) { return error_of([&] { validate(sets, mesh); }); };
    EXPECT_EQ(refused({{}, {}, {{"a", {{0, 1}, {1, 255}}}}}), "no error");
    EXPECT_THAT(refused({{}, {}, {{"a", {{2, 1}}}}}), HasSubstr("set of nodes \"a\" has cell 2 (less than 2)"));
    EXPECT_THAT(refused({{}, {}, {{"a", {{1, 1}, {1, 2}}}}}), HasSubstr("set of nodes \"a\" has cell 1 more than once"));
    EXPECT_THAT(refused({{}, {}, {{"a", {}}, {"a", {}}}}), HasSubstr("two sets of nodes have the name \"a\""));
    const MeshSets sets{{{"in", {}}}, {{"core", {}}}, {{"a", {}}, {"b", {}}}};
    EXPECT_EQ(list_of(sets), "1 patch (in), 1 set of cells (core) and 2 sets of nodes (a, b)");
    EXPECT_EQ(list_of({{}, {}, {{"a", {}}}}), "1 set of nodes (a)");
    EXPECT_EQ(list_of({{}, {{"core", {}}}, {{"a", {}}}}), "1 set of cells (core) and 1 set of nodes (a)");
    EXPECT_THAT(error_of([&] { std::ignore = find_node_set(sets, "c"); }),
                HasSubstr("there is no set of nodes \"c\" (the mesh has: a, b)"));
}

TEST(SharpTags, OfGroupsThatAreNotThereAreRefused) {
    const std::vector<std::string> wanted{"wall", "7"};
    SharpGroups groups(wanted);
    EXPECT_FALSE(groups.takes("inlet", "3"));
    EXPECT_THAT(error_of([&] { groups.check("a.msh"); }), HasSubstr("a.msh: there is no group \"7\" of faces or edges"));
    EXPECT_TRUE(groups.takes("outlet", "7"));
    EXPECT_THAT(error_of([&] { groups.check("a.msh"); }), HasSubstr("\"wall\""));
    EXPECT_THAT(error_of([&] { groups.check("a.msh"); }), HasSubstr("it has: inlet, outlet"));
    EXPECT_TRUE(groups.takes("wall"));
    groups.check("a.msh");
    EXPECT_FALSE(SharpGroups({}).any());
}

}  // namespace file_sets_test
}  // namespace subvol::detail
