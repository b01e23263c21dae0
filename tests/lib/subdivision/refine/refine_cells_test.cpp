// SPDX-License-Identifier: Apache-2.0
#include "subvol/refine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_io.h"

namespace subvol {
namespace refine_cells_test {

HexMesh with_field(HexMesh mesh) {
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(3 * p.x + p.y) + p.z * p.z; });
    return mesh;
}

/// Every third cell of five, so that there are wanted cells alone, side by side, inside and at the boundary.
std::vector<Index> some_cells(const HexMesh& mesh) {
    std::vector<Index> cells;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        if (c % 11 == 3 || c % 11 == 4) cells.push_back(c);
    }
    return cells;
}

/// Bitwise: the same doubles at the same corners.
void expect_same_as_global(const HexMesh& mesh, const RefineOptions& options) {
    const auto cells = some_cells(mesh);
    ASSERT_FALSE(cells.empty());
    const HexMesh local = refine_cells(mesh, cells, options), global = refine(mesh, options);
    const std::size_t descendants = std::size_t{1} << (3 * options.levels);
    ASSERT_EQ(local.cells.size(), cells.size() * descendants);
    std::size_t differing = 0;
    for (std::size_t i = 0; i < local.cells.size(); ++i) {
        const auto& theirs = global.cells[cells[i / descendants] * descendants + i % descendants];
        for (std::size_t k = 0; k < 8; ++k) {
            differing += local.points[local.cells[i][k]] != global.points[theirs[k]];
            for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
                differing += local.attributes[a].values[local.cells[i][k]] != global.attributes[a].values[theirs[k]];
            }
        }
    }
    EXPECT_EQ(differing, 0u);
}

class EveryScheme : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, EveryScheme,
                         testing::Values(Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear));

TEST_P(EveryScheme, CellsAloneAreRefinedAsInTheWholeMesh) {
    HexMesh mesh = with_field(test::make_nested_cubes(3));
    test::jitter(mesh, .03, 7);
    for (const int levels : {0, 1, 2, 3}) expect_same_as_global(mesh, {.scheme = {GetParam()}, .levels = levels});
}

TEST_P(EveryScheme, KeepsCreasesAndSharpFaces) {
    HexMesh mesh = with_field(test::make_box(5, 4, 4));
    for (auto& p : mesh.points) p += Vec3(.2 * std::sin(p.y + p.z), .3 * std::sin(p.x), .2 * std::cos(p.x * p.y));
    const auto id = [](Index i, Index j, Index k) { return i + 6 * (j + 5 * k); };
    for (Index i = 0; i < 5; ++i) mesh.creases.push_back({id(i, 2, 4), id(i + 1, 2, 4)});  // along the top
    for (Index j = 0; j < 3; ++j) mesh.sharp_faces.push_back({id(2, j, 1), id(2, j + 1, 1), id(2, j + 1, 2), id(2, j, 2)});
    expect_same_as_global(mesh, {.scheme = {GetParam()}, .levels = 2});
    expect_same_as_global(mesh, {.scheme = {.kind = GetParam(), .crease_angle_deg = 10}, .levels = 2});
}

TEST_P(EveryScheme, HoldsOnRealMeshes) {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "SUBVOL_DATA does not name the folder of real meshes";
    for (const char* name : {"amanzi_hexes_192.mesh", "hexdom_igea_improve.vtk"}) {
        expect_same_as_global(with_field(read_mesh(*data / name).mesh), {.scheme = {GetParam()}, .levels = 2});
    }
}

TEST(RefineCells, KeepsTheTagsOfThePart) {
    HexMesh mesh = test::make_box(4, 4, 2);
    mesh.creases = {{52, 57}, {57, 62}, {62, 67}};  // along the top, y from 0 to 3 at x = 2
    const HexMesh part = refine_cells(mesh, std::vector<Index>{17}, {.levels = 1});
    EXPECT_EQ(part.creases.size(), 2u) << "both halves of the one crease at the cell";
}

TEST(RefineCells, AcceptsTagsThatThePartCannotCheck) {
    // The crease is on the boundary only because of a fin of one cell, which is far from some of the selected cells.
    HexMesh mesh = with_field(test::make_box(4, 4, 1));
    const auto id = [](Index i, Index j, Index k) { return i + 5 * (j + 5 * k); };
    const Index a = id(2, 2, 0), b = id(2, 2, 1), n = static_cast<Index>(mesh.points.size());
    for (int k = 0; k < 6; ++k) mesh.points.emplace_back(2 + k % 3, 2 + k / 3, 5);
    mesh.attributes[0].values.resize(mesh.points.size(), 1.0);
    mesh.cells.push_back({a, n, n + 1, n + 2, b, n + 3, n + 4, n + 5});
    mesh.creases = {{a, b}};
    const std::vector<Index> corners{0, 3, 12, 15};
    const HexMesh local = refine_cells(mesh, corners, {.levels = 2}), global = refine(mesh, {.levels = 2});
    for (std::size_t i = 0; i < local.cells.size(); ++i) {
        EXPECT_EQ(local.points[local.cells[i][7]], global.points[global.cells[64 * corners[i / 64] + i % 64][7]]);
    }
}

TEST(RefineCells, RefusesInvalidMeshes) {
    HexMesh mesh = test::make_box(9, 1, 1);
    mesh.cells.push_back(mesh.cells[7]);
    test::expect_error(ErrorCode::InvalidInput, "cells 7 and 9", [&] { (void)refine_cells(mesh, std::vector<Index>{0}); });
}

TEST(RefineCells, RefusesCellsThatDoNotExist) {
    const HexMesh mesh = test::make_box(2, 1, 1);
    test::expect_error(ErrorCode::InvalidInput, "there is no cell 2", [&] { (void)refine_cells(mesh, std::vector<Index>{2}); });
    test::expect_error(ErrorCode::InvalidInput, "cell 1 is listed twice", [&] {
        (void)refine_cells(mesh, std::vector<Index>{1, 1});
    });
}

}  // namespace refine_cells_test
}  // namespace subvol
