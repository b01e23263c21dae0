// SPDX-License-Identifier: Apache-2.0
// Several levels at once derive the topology of each level from its parent; one level at a time builds it by sorting. Both must
// give the same mesh, to the last bit and number.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/test_meshes.h"
#include "subvol/mesh_io.h"
#include "subvol/refine.h"

namespace subvol {
namespace levels_test {

void expect_same_as_stepwise(HexMesh mesh, const RefineOptions& options) {
    test::add_field(mesh, "g", [](const Vec3& p) { return std::sin(p.x) + p.y * p.z; });
    const HexMesh direct = refine(mesh, options);
    HexMesh stepwise = mesh;
    RefineOptions one = options;
    one.levels = 1;
    for (int level = 0; level < options.levels; ++level) stepwise = refine(stepwise, one);
    EXPECT_EQ(direct.cells, stepwise.cells);
    EXPECT_TRUE(direct.points == stepwise.points);
    EXPECT_TRUE(direct.attributes.back().values == stepwise.attributes.back().values);
    EXPECT_EQ(direct.creases, stepwise.creases);
    EXPECT_EQ(direct.sharp_faces.size(), stepwise.sharp_faces.size());
}

class RefinedInLevels : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Levels, RefinedInLevels,
                         testing::Values(Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear));

TEST_P(RefinedInLevels, IrregularEdges) {
    HexMesh mesh = test::make_nested_cubes(2);
    test::jitter(mesh, .04, 1);
    expect_same_as_stepwise(mesh, {.scheme = {GetParam()}, .levels = 3});
}

TEST_P(RefinedInLevels, CellsTurnedAndInAnyOrder) {
    HexMesh mesh = test::make_nested_cubes(2);
    std::mt19937 random(8);
    std::shuffle(mesh.cells.begin(), mesh.cells.end(), random);
    for (auto& c : mesh.cells) {
        for (unsigned turns = random() % 4; turns > 0; --turns) c = {c[1], c[2], c[3], c[0], c[5], c[6], c[7], c[4]};
        if (random() % 2) c = {c[0], c[4], c[5], c[1], c[3], c[7], c[6], c[2]};
    }
    expect_same_as_stepwise(mesh, {.scheme = {GetParam()}, .levels = 2});
}

TEST_P(RefinedInLevels, CreasesAndSharpFaces) {
    HexMesh mesh = test::make_box(3, 3, 3);
    test::jitter(mesh, .1, 2);
    const auto id = [](Index i, Index j, Index k) { return i + 4 * (j + 4 * k); };
    mesh.creases = {{id(1, 0, 3), id(1, 1, 3)}, {id(1, 1, 3), id(1, 2, 3)}};
    mesh.sharp_faces = {{id(1, 1, 1), id(1, 2, 1), id(1, 2, 2), id(1, 1, 2)},
                        {id(1, 0, 1), id(1, 1, 1), id(1, 1, 2), id(1, 0, 2)}};
    expect_same_as_stepwise(mesh, {.scheme = {GetParam()}, .levels = 3});
}

TEST_P(RefinedInLevels, CellsThatTouchAlongAnEdgeOrAtAPoint) {
    HexMesh mesh = test::make_box(2, 2, 2);
    mesh.cells = {mesh.cells[0], mesh.cells[3], mesh.cells[4], mesh.cells[7]};
    expect_same_as_stepwise(mesh, {.scheme = {GetParam()}, .levels = 2});
    mesh.cells = {mesh.cells[0], mesh.cells[3]};
    expect_same_as_stepwise(mesh, {.scheme = {GetParam()}, .levels = 2});
}

TEST_P(RefinedInLevels, ARingOfThreeCells) {
    // A closed ring: the far neighbour on one side is the same cell as on the other.
    HexMesh mesh = test::make_box(1, 1, 3);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const double angle = 2 * std::acos(-1.0) / 3 * mesh.points[p].z, radius = 2 + mesh.points[p].x;
        mesh.points[p] = {radius * std::cos(angle), radius * std::sin(angle), mesh.points[p].y};
    }
    for (Index k = 0; k < 4; ++k) mesh.cells[2][4 + k] = mesh.cells[0][k];
    mesh.points.resize(12);
    expect_same_as_stepwise(mesh, {.scheme = {GetParam()}, .levels = 3});
}

TEST_P(RefinedInLevels, RealMeshes) {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    for (const char* name : {"data/amanzi_hexes_192.mesh", "data/hexdom_igea_improve.vtk",
                             "bad/08_two_components_edge_contact_ok.mesh", "expected/dart_5octants.mesh"}) {
        SCOPED_TRACE(name);
        expect_same_as_stepwise(read_mesh(data->parent_path() / name).mesh, {.scheme = {GetParam()}, .levels = 2});
    }
}

}  // namespace levels_test
}  // namespace subvol
