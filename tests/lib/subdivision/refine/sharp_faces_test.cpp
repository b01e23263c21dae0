// SPDX-License-Identifier: Apache-2.0
// Sharp faces inside a mesh: both sides are refined as if the other were not there.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/mesh_report.h"
#include "subvol/refine.h"

namespace subvol {
namespace sharp_faces_test {

HexMesh bent_box(Index nx) {
    HexMesh mesh = test::make_box(nx, 3, 3);
    for (auto& p : mesh.points) p += .1 * Vec3(std::sin(2 * p.y), std::cos(p.x + p.z), std::sin(p.x * p.y));
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(3 * p.x) + p.y * p.z; });
    return mesh;
}

class SharpFaces : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, SharpFaces, testing::Values(Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear));

TEST_P(SharpFaces, DivideAMeshAsIfItWereTwo) {
    HexMesh whole = bent_box(5);
    const auto id = [](Index i, Index j, Index k) { return i + 6 * (j + 4 * k); };
    for (Index k = 0; k < 3; ++k) {
        for (Index j = 0; j < 3; ++j)
            whole.sharp_faces.push_back({id(2, j, k), id(2, j + 1, k), id(2, j + 1, k + 1), id(2, j, k + 1)});
    }
    HexMesh left = whole, right = whole;
    left.sharp_faces.clear();
    right.sharp_faces.clear();
    std::vector<Index> left_cells, right_cells;
    left.cells.clear();
    right.cells.clear();
    for (Index c = 0; c < whole.cells.size(); ++c) {
        (c % 5 < 2 ? left_cells : right_cells).push_back(c);
        (c % 5 < 2 ? left : right).cells.push_back(whole.cells[c]);
    }
    const RefineOptions options{.scheme = {GetParam()}, .levels = 2};
    const HexMesh fine = refine(whole, options);
    const auto compare = [&](const HexMesh& part, const std::vector<Index>& cells) {
        const HexMesh alone = refine(part, options);
        for (std::size_t i = 0; i < alone.cells.size(); ++i) {
            const auto& theirs = fine.cells[64 * cells[i / 64] + i % 64];
            for (std::size_t k = 0; k < 8; ++k) {
                ASSERT_NEAR(glm::distance(alone.points[alone.cells[i][k]], fine.points[theirs[k]]), 0, 1e-14);
                ASSERT_NEAR(alone.attributes[0].values[alone.cells[i][k]], fine.attributes[0].values[theirs[k]], 1e-14);
            }
        }
    };
    compare(left, left_cells);
    compare(right, right_cells);
}

TEST_P(SharpFaces, KeepAJumpOfTheSlope) {
    // |x − 2| bends at the sharp plane and nowhere else: each side is linear.
    HexMesh mesh = test::make_box(4, 2, 2);
    test::add_field(mesh, "bend", [](const Vec3& p) { return std::abs(p.x - 2); });
    const auto worst = [&](const HexMesh& m) {
        const HexMesh fine = refine(m, {.scheme = {GetParam()}, .levels = 2});
        double most = 0;
        for (std::size_t p = 0; p < fine.points.size(); ++p) {
            most = std::max(most, std::abs(fine.attributes[0].values[p] - std::abs(fine.points[p].x - 2)));
        }
        return most;
    };
    HexMesh sharp = mesh;
    const auto id = [](Index i, Index j, Index k) { return i + 5 * (j + 3 * k); };
    for (Index k = 0; k < 2; ++k) {
        for (Index j = 0; j < 2; ++j)
            sharp.sharp_faces.push_back({id(2, j, k), id(2, j + 1, k), id(2, j + 1, k + 1), id(2, j, k + 1)});
    }
    EXPECT_LT(worst(sharp), 1e-13);
    const bool smooth = GetParam() != Scheme::Linear;
    EXPECT_EQ(worst(mesh) > .01, smooth) << "without it a smooth scheme rounds the bend";
}

TEST_P(SharpFaces, MayEndInsideTheMesh) {
    HexMesh mesh = bent_box(4);
    const auto id = [](Index i, Index j, Index k) { return i + 5 * (j + 4 * k); };
    mesh.sharp_faces = {{id(2, 1, 1), id(2, 2, 1), id(2, 2, 2), id(2, 1, 2)}};
    const HexMesh fine = refine(mesh, {.scheme = {GetParam()}, .levels = 2});
    EXPECT_EQ(fine.sharp_faces.size(), 16u);
    EXPECT_EQ(measure_cells(fine).inverted_cells, 0u);
}

TEST(SharpFacesAndReports, LeaveTheHullAlone) {
    HexMesh mesh = test::make_box(2, 1, 1);
    mesh.sharp_faces = {{1, 4, 10, 7}};
    const MeshReport report = inspect(mesh);
    EXPECT_EQ(report.boundary_faces, 10u);
    HexMesh cube = test::make_box(2, 2, 2);
    cube.sharp_faces = {{1, 4, 13, 10}};
    EXPECT_EQ(inspect(cube).interior_edges, 6u);
    EXPECT_EQ(refinement_tables(build_topology(mesh), {.levels = 0}).sharp_faces.size(), 1u);
    mesh.sharp_faces = {{1, 4, 10, 8}};
    test::expect_error(ErrorCode::InvalidInput, "points 1 4 10 8 are not a face", [&] { (void)refine(mesh); });
    mesh.sharp_faces = {{1, 4, 10, 99}};
    test::expect_error(ErrorCode::InvalidInput, "point 99 does not exist", [&] { (void)refine(mesh); });
    mesh.points.push_back({9, 9, 9});
    mesh.sharp_faces = {{1, 4, 10, 12}};
    test::expect_error(ErrorCode::InvalidInput, "point 12 belongs to no cell", [&] { (void)refine(mesh); });
}

}  // namespace sharp_faces_test
}  // namespace subvol
