// SPDX-License-Identifier: Apache-2.0
// Groups of faces and edges of a file that are kept sharp.

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <set>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "mesh_texts.h"
#include "subvol/mesh_io.h"
#include "subvol/topology.h"

namespace subvol::test {

namespace sharp_groups_test {

using testing::HasSubstr;
using Quads = std::vector<std::array<Index, 4>>;
using Edges = std::vector<std::array<Index, 2>>;

constexpr Index kNx = 4, kNy = 2, kNz = 2;
const HexMesh kBox = make_box(kNx, kNy, kNz);

Index id(Index i, Index j, Index k) {
    return i + (kNx + 1) * (j + (kNy + 1) * k);
}

/// The plane x = i of the box.
Quads plane(Index i) {
    Quads quads;
    for (Index k = 0; k < kNz; ++k) {
        for (Index j = 0; j < kNy; ++j) quads.push_back({id(i, j, k), id(i, j + 1, k), id(i, j + 1, k + 1), id(i, j, k + 1)});
    }
    return quads;
}

/// A line on the top of the box, and one inside the plane x = 2.
const Edges kTop{{id(0, 1, kNz), id(1, 1, kNz)}, {id(1, 1, kNz), id(2, 1, kNz)}}, kInPlane{{id(2, 1, 0), id(2, 1, 1)}};

std::vector<std::set<Index>> sets_of(const auto& tags) {
    std::vector<std::set<Index>> sets;
    for (const auto& tag : tags) sets.emplace_back(tag.begin(), tag.end());
    std::ranges::sort(sets);
    return sets;
}

void expect_plane_and_lines(const HexMesh& mesh) {
    EXPECT_EQ(sets_of(mesh.sharp_faces), sets_of(plane(2)));
    Edges lines = kTop;
    lines.insert(lines.end(), kInPlane.begin(), kInPlane.end());
    EXPECT_EQ(sets_of(mesh.creases), sets_of(lines));
    const Topology topology = build_topology(mesh);
    for (const auto& [a, b] : mesh.creases) EXPECT_TRUE(topology.edge_is_crease[topology.find_edge(a, b).value()]);
    for (const auto& quad : mesh.sharp_faces) EXPECT_TRUE(topology.face_is_sharp[topology.find_face(quad).value()]);
}

template <class Tag>
std::string words(const Tag& tag) {
    std::string text;
    for (const Index p : tag) text += " " + std::to_string(p + 1);
    return text;
}

/// Gmsh 2: the plane is the group "cut" (7), the lines are the group "the rim" (3), and a face on the hull is in the group 9.
std::string gmsh_2() {
    std::vector<std::string> elements;
    for (const auto& quad : plane(2)) elements.push_back("3 2 7 1" + words(quad));
    elements.push_back("3 2 9 1" + words(plane(0)[0]));
    for (const auto& lines : {kTop, kInPlane}) {
        for (const auto& line : lines) elements.push_back("1 2 3 1" + words(line));
    }
    for (const auto& cell : kBox.cells) elements.push_back("5 2 1 1" + words(cell));
    std::string text = gmsh_text(kBox, "0");
    text.resize(text.find("$Elements"));
    text =
        replaced(text, "$Nodes", "$PhysicalNames\n3\n2 7 \"cut\"\n1 3 \"the rim\"\n3 1 \"solid\"\n$EndPhysicalNames\n$Nodes");
    text += "$Elements\n" + std::to_string(elements.size()) + "\n";
    for (std::size_t e = 0; e < elements.size(); ++e) text += std::to_string(e + 1) + " " + elements[e] + "\n";
    return text + "$EndElements\n";
}

/// Gmsh 4.0 or 4.1: groups are those of the entities of the geometry.
std::string gmsh_4(bool v41) {
    const std::string box = " 0 0 0 4 2 2 ", point = v41 ? " 0 0 0 " : " 0 0 0 0 0 0 ";
    std::string text = "$MeshFormat\n" + std::string(v41 ? "4.1" : "4") + " 0 8\n$EndMeshFormat\n";
    text += "$PhysicalNames\n2\n2 7 \"cut\"\n1 3 \"the rim\"\n$EndPhysicalNames\n$Entities\n1 1 2 1\n1" + point + "1 3\n";
    text += "5" + box + "1 3 2 1 -1\n5" + box + "2 12 -7 1 5\n6" + box + "0 0\n1" + box + "1 1 2 5 6\n$EndEntities\n$Nodes\n";
    const std::string points = std::to_string(kBox.points.size());
    text += v41 ? "1 " + points + " 1 " + points + "\n3 1 0 " + points + "\n" : "1 " + points + "\n1 3 0 " + points + "\n";
    for (std::size_t p = 0; v41 && p < kBox.points.size(); ++p) text += std::to_string(p + 1) + "\n";
    for (std::size_t p = 0; p < kBox.points.size(); ++p) {
        const Vec3& x = kBox.points[p];
        text += (v41 ? "" : std::to_string(p + 1) + " ") + number(x.x) + " " + number(x.y) + " " + number(x.z) + "\n";
    }
    std::size_t count = 0;
    std::string blocks;
    const auto block = [&](int dimension, int entity, int type, const auto& tags) {
        blocks += v41 ? std::to_string(dimension) + " " + std::to_string(entity)
                      : std::to_string(entity) + " " + std::to_string(dimension);
        blocks += " " + std::to_string(type) + " " + std::to_string(tags.size()) + "\n";
        for (const auto& tag : tags) blocks += std::to_string(++count) + words(tag) + "\n";
    };
    block(1, 5, 1, kTop);
    block(1, 5, 1, kInPlane);
    block(2, 5, 3, plane(2));
    block(2, 6, 3, plane(1));
    block(3, 1, 5, kBox.cells);
    const std::string total = std::to_string(count);
    return text + "$EndNodes\n$Elements\n5 " + total + (v41 ? " 1 " + total : "") + "\n" + blocks + "$EndElements\n";
}

template <class... Number>
std::string bytes(const Number&... numbers) {
    std::string result;
    (result.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
    return result;
}

/// The same in binary, version 4.1: sizes and numbers of nodes are 64-bit, those of entities 32-bit.
std::string gmsh_4_binary() {
    using Size = std::uint64_t;
    std::string text = "$MeshFormat\n4.1 1 8\n" + bytes(1) +
                       "\n$EndMeshFormat\n$PhysicalNames\n2\n2 7 \"cut\"\n1 3 \"the rim\"\n$EndPhysicalNames\n$Entities\n";
    const std::string box = bytes(0., 0., 0., 4., 2., 2.);
    text += bytes(Size{1}, Size{1}, Size{2}, Size{1}) + bytes(1, 0., 0., 0., Size{1}, 3);
    text += bytes(5) + box + bytes(Size{1}, 3, Size{2}, 1, -1);
    text += bytes(5) + box + bytes(Size{2}, 12, -7, Size{1}, 5) + bytes(6) + box + bytes(Size{0}, Size{0});
    text += bytes(1) + box + bytes(Size{1}, 1, Size{2}, 5, 6) + "\n$EndEntities\n$Nodes\n";
    const Size points = kBox.points.size();
    text += bytes(Size{1}, points, Size{1}, points) + bytes(3, 1, 0, points);
    for (Size p = 1; p <= points; ++p) text += bytes(p);
    for (const Vec3& x : kBox.points) text += bytes(x.x, x.y, x.z);
    Size count = 0, groups = 0;
    std::string blocks;
    const auto block = [&](int dimension, int entity, int type, const auto& tags) {
        ++groups;
        blocks += bytes(dimension, entity, type, Size{tags.size()});
        for (const auto& tag : tags) {
            blocks += bytes(++count);
            for (const Index p : tag) blocks += bytes(Size{p} + 1);
        }
    };
    block(1, 5, 1, kTop);
    block(1, 5, 1, kInPlane);
    block(2, 5, 3, plane(2));
    block(2, 6, 3, plane(1));
    block(3, 1, 5, kBox.cells);
    return text + "\n$EndNodes\n$Elements\n" + bytes(groups, count, Size{1}, count) + blocks + "\n$EndElements\n";
}

/// MEDIT: the plane has the reference 7, the line in it is a ridge, and the line on the top has the reference 3.
std::string medit() {
    std::string tags = "Edges\n3\n";
    for (const auto& line : kTop) tags += words(line) + " 3\n";
    for (const auto& line : kInPlane) tags += words(line) + " 0\n";
    tags += "Ridges\n1\n3\nQuadrilaterals\n5\n" + words(plane(1)[0]) + " 8\n";
    for (const auto& quad : plane(2)) tags += words(quad) + " 7\n";
    return replaced(medit_text(kBox), "Hexahedra", tags + "Hexahedra");
}

class SharpGroups : public TempFolder {
protected:
    [[nodiscard]] ReadResult read(const std::string& name, const std::string& text, std::vector<std::string> sharp) const {
        return read_mesh(write(name, text), {.sharp = std::move(sharp)});
    }
    [[nodiscard]] std::string read_error(const std::string& name, const std::string& text, const std::string& group) const {
        return error_of([&] { static_cast<void>(read(name, text, {group})); });
    }
};

TEST_F(SharpGroups, OfGmshAreNamedOrNumbered) {
    expect_plane_and_lines(read("a.msh", gmsh_2(), {"cut", "the rim"}).mesh);
    expect_plane_and_lines(read("a.msh", gmsh_2(), {"7", "3"}).mesh);
    expect_plane_and_lines(read("a.msh", gmsh_2(), {"9", "cut", "the rim"}).mesh);  // on the hull a tag changes nothing
    for (const bool v41 : {false, true}) {
        expect_plane_and_lines(read("a.msh", gmsh_4(v41), {"cut", "the rim"}).mesh);
        expect_plane_and_lines(read("a.msh", gmsh_4(v41), {"12", "3"}).mesh);
        EXPECT_EQ(read("a.msh", gmsh_4(v41), {"cut"}).mesh.creases.size(), 0u);
    }
    expect_plane_and_lines(read("a.msh", gmsh_4_binary(), {"cut", "the rim"}).mesh);
    expect_plane_and_lines(read("a.msh", gmsh_4_binary(), {"12", "3"}).mesh);
    const std::string whole = gmsh_4_binary();
    const std::size_t begin = whole.find("$Entities"), end = whole.find("\n$EndEntities");
    for (std::size_t length = begin + 12; length < end; length += 7) {  // cut off in every entity
        EXPECT_THAT(read_error("a.msh", whole.substr(0, length), "cut"), HasSubstr("a.msh"));
    }
    const ReadResult plain = read("a.msh", gmsh_2(), {});
    EXPECT_TRUE(plain.mesh.sharp_faces.empty() && plain.mesh.creases.empty());
    EXPECT_THAT(plain.warnings, testing::ElementsAre(HasSubstr("patch \"cut\" left out")));  // the others are a patch and a set
}

TEST_F(SharpGroups, OfMeditAreReferencesAndRidges) {
    expect_plane_and_lines(read("a.mesh", medit(), {"7", "3", "Ridges"}).mesh);
    // Sections may come before the vertices.
    const std::string text = medit();
    const std::size_t tags = text.find("Edges"), hexes = text.find("Hexahedra");
    const std::string early =
        replaced(text.substr(0, tags) + text.substr(hexes), "Vertices", text.substr(tags, hexes - tags) + "Vertices");
    expect_plane_and_lines(read("a.mesh", early, {"7", "3", "Ridges"}).mesh);
    EXPECT_EQ(read("a.mesh", medit(), {"8"}).mesh.sharp_faces.size(), 1u);
}

TEST_F(SharpGroups, AreWrittenAsMeditAndReadAgain) {
    const HexMesh mesh = read("a.mesh", medit(), {"7", "3", "Ridges"}).mesh;
    const auto file = path("b.mesh");
    EXPECT_THAT(write_mesh(file, mesh), testing::ElementsAre(HasSubstr("3 creases and 4 sharp faces written as groups")));
    expect_plane_and_lines(read_mesh(file, {.sharp = {"1"}}).mesh);
    EXPECT_EQ(sets_of(read_mesh(file, {.sharp = {"Ridges", "1"}}).mesh.creases), sets_of(mesh.creases));
    EXPECT_TRUE(read_mesh(file).mesh.creases.empty());
}

TEST_F(SharpGroups, AreInFilesOfVtkAndReadAgain) {
    HexMesh mesh = read("a.mesh", medit(), {"7", "3", "Ridges"}).mesh;
    const auto file = path("b.vtu");
    EXPECT_TRUE(write_mesh(file, mesh).empty());
    const ReadResult again = read_mesh(file);
    expect_plane_and_lines(again.mesh);
    EXPECT_TRUE(again.warnings.empty());

    // A program that leaves out a cell keeps the list.
    std::string text = test::read_bytes(file);
    const std::size_t at = text.find("<FieldData>"), end = text.find("</FieldData>");
    const std::string list = text.substr(at, end - at);
    mesh.creases.clear();
    mesh.sharp_faces.clear();
    mesh.cells.pop_back();
    std::ignore = write_mesh(path("less.vtu"), mesh);
    text = test::read_bytes(path("less.vtu"));
    text.insert(text.find("<Piece"), list + "</FieldData>");
    std::ofstream(path("less.vtu")) << text;
    const ReadResult less = read_mesh(path("less.vtu"));
    EXPECT_THAT(less.warnings, testing::ElementsAre(HasSubstr("ignored: it is of another mesh")));
    EXPECT_TRUE(less.mesh.creases.empty() && less.mesh.sharp_faces.empty());
}

TEST_F(SharpGroups, AreWeldedWithTheirCells) {
    // The box as two halves with points of their own, which touch at the plane x = 2; the tags name the points of the first.
    HexMesh apart = kBox;
    for (const auto& quad : plane(2)) {
        for (const Index p : quad) apart.points.push_back(kBox.points[p]);
    }
    const auto copy_of = [&](Index p) {
        if (kBox.points[p].x != 2) return p;
        const auto found = std::find(apart.points.begin() + static_cast<std::ptrdiff_t>(kBox.points.size()), apart.points.end(),
                                     kBox.points[p]);
        return static_cast<Index>(found - apart.points.begin());
    };
    for (auto& cell : apart.cells) {
        if (kBox.points[cell[0]].x < 2) continue;
        for (Index& p : cell) p = copy_of(p);
    }
    const std::string tags = medit().substr(medit().find("Edges"));
    const std::string text = replaced(medit_text(apart), "Hexahedra", tags.substr(0, tags.find("Hexahedra")) + "Hexahedra");
    const auto file = write("a.mesh", text);
    const HexMesh welded = read_mesh(file, {.weld = 0, .sharp = {"7", "3", "Ridges"}}).mesh;
    EXPECT_EQ(build_topology(welded).faces.size(), build_topology(kBox).faces.size());
    EXPECT_EQ(welded.sharp_faces.size(), 4u);
    EXPECT_EQ(welded.creases.size(), 3u);
    for (const auto& quad : welded.sharp_faces) {
        for (const Index p : quad) EXPECT_EQ(welded.points[p].x, 2);
    }
    // Apart, the plane is a part of the hull, where tags change nothing.
    EXPECT_TRUE(read_mesh(file, {.sharp = {"7"}}).mesh.sharp_faces.empty());
}

TEST_F(SharpGroups, AreSplitWithTheirCells) {
    // A prism on a side of the box: all cells are split, and so are the tags. Two tetrahedra share a triangle.
    HexMesh mesh = kBox;
    mesh.points.emplace_back(5, .5, 0);
    mesh.points.emplace_back(5, .5, 1);
    const std::string side = words(std::array{id(4, 0, 0), id(4, 1, 0), Index{45}, id(4, 0, 1), id(4, 1, 1), Index{46}});
    std::string text = medit_text(mesh);
    const std::string tags = medit().substr(medit().find("Edges"));
    text = replaced(text, "Hexahedra", "Prisms\n1\n" + side + " 0\n" + tags.substr(0, tags.find("Hexahedra")) + "Hexahedra");
    const HexMesh split = read("a.mesh", text, {"7", "3", "Ridges"}).mesh;
    EXPECT_EQ(split.cells.size(), 8 * kBox.cells.size() + 6);
    EXPECT_EQ(split.sharp_faces.size(), 16u);
    EXPECT_EQ(split.creases.size(), 6u);
    for (const auto& quad : split.sharp_faces) {
        for (const Index p : quad) EXPECT_EQ(split.points[p].x, 2);
    }
    EXPECT_NO_THROW(static_cast<void>(build_topology(split)));
    const std::string tets =
        "MeshVersionFormatted 1\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 -1 0\n"
        "Triangles\n1\n1 2 3 4\nTetrahedra\n2\n1 2 3 4 0\n1 3 2 5 0\nEnd\n";
    const HexMesh of_tets = read("a.mesh", tets, {"4"}).mesh;
    EXPECT_EQ(of_tets.sharp_faces.size(), 3u);
    for (const auto& quad : of_tets.sharp_faces) {
        for (const Index p : quad) EXPECT_EQ(of_tets.points[p].z, 0);
    }
}

TEST_F(SharpGroups, RefuseWhatIsNotThere) {
    EXPECT_THAT(read_error("a.msh", gmsh_2(), "kut"), HasSubstr("a.msh: there is no group \"kut\" of faces or edges"));
    EXPECT_THAT(read_error("a.msh", gmsh_2(), "kut"), HasSubstr("it has: 9, cut, the rim"));
    EXPECT_THAT(read_error("a.msh", gmsh_2(), "solid"), HasSubstr("there is no group \"solid\""));
    EXPECT_THAT(read_error("a.mesh", medit(), "1"), HasSubstr("it has: 0, 3, 7, 8, Ridges"));
    EXPECT_THAT(read_error("a.mesh", medit_text(kBox), "1"), HasSubstr("the file has none"));
    EXPECT_THAT(read_error("a.vtk", vtk_text(kBox), "1"), HasSubstr("groups of faces and edges are not read from such files"));
    const std::string first = words(plane(1)[0]) + " 8";
    EXPECT_THAT(read_error("a.mesh", replaced(medit(), first, " 1 2 3 4 8"), "8"),
                HasSubstr("vertex 1, vertex 2, vertex 3, vertex 4: they are not a face of a cell"));
    EXPECT_THAT(read_error("a.mesh", medit(), "Ridges"), HasSubstr("the edge lies inside the mesh"));
    EXPECT_THAT(read_error("a.mesh", replaced(medit(), "Ridges\n1\n3", "Ridges\n1\n4"), "Ridges"),
                HasSubstr("there is no edge with index 4"));
}

}  // namespace sharp_groups_test

}  // namespace subvol::test
