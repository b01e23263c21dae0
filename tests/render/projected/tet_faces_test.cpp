// SPDX-License-Identifier: Apache-2.0
#include "tet_faces.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <set>

#include "render/hex_meshes.h"

namespace subvol {

using namespace detail;
namespace tet_faces_test {

TetMesh split(const HexMesh& mesh) {
    return build_tet_mesh(mesh, std::vector<double>(mesh.points.size(), 1.0));
}

TEST(TetFaces, EveryFaceIsThereOnceAndTheBoundaryFirst) {
    for (const HexMesh& hexes : {test::box(3), test::jittered_box(4, 0.3, 7), test::ball(4), test::l_shape(4)}) {
        const TetMesh mesh = split(hexes);
        const TetFaces faces = find_faces(mesh);
        EXPECT_EQ(2 * faces.faces.size(), 4 * mesh.tets.size() + mesh.boundary.size());
        EXPECT_EQ(faces.outer, mesh.boundary.size());
        std::set<std::array<Index, 3>> corners;
        for (std::size_t i = 0; i < faces.faces.size(); ++i) {
            const auto& face = faces.faces[i];
            EXPECT_TRUE(std::ranges::is_sorted(face.corner));
            EXPECT_TRUE(corners.insert(face.corner).second);
            if (i < faces.outer) {
                EXPECT_TRUE(face.cover == 1 || face.cover == 3) << i;
            } else {
                EXPECT_EQ(face.cover, 2u) << i;
            }
        }
    }
}

TEST(TetFaces, CoverTellsTheSideOfTheTetrahedron) {
    const TetMesh mesh = split(test::jittered_box(4, 0.3, 7));
    const TetFaces faces = find_faces(mesh);
    const Vec3 middle(0.5);  // inside of every face of the box
    for (std::size_t i = 0; i < faces.outer; ++i) {
        const auto& [corner, cover] = faces.faces[i];
        const Vec3& p = mesh.points[corner[0]].position;
        const Vec3 normal = cross(mesh.points[corner[1]].position - p, mesh.points[corner[2]].position - p);
        EXPECT_EQ(cover == 3, dot(normal, middle - p) > 0) << i;
    }
}

TEST(TetFaces, WhereCellsFoldOverFacesAreOuter) {
    const TetMesh mesh = split(test::jittered_box(5, 0.9, 4));
    ASSERT_GT(mesh.shapes.inverted, 0u);
    const TetFaces faces = find_faces(mesh);
    EXPECT_GT(faces.outer, mesh.boundary.size());
    for (std::size_t i = 0; i < faces.outer; ++i) EXPECT_NE(faces.faces[i].cover, 2u);
}

TEST(TetFaces, PartsHaveTheBoundaryAndLieEvenly) {
    const TetMesh mesh = split(test::box(8));
    const TetFaces faces = find_faces(mesh);
    EXPECT_EQ(faces.count(0), faces.outer);
    EXPECT_EQ(faces.count(1), faces.faces.size());
    const std::size_t inner = faces.faces.size() - faces.outer, tenth = faces.count(0.1) - faces.outer;
    EXPECT_EQ(tenth, (inner + 9) / 10);
    std::size_t left = 0;
    for (std::size_t i = faces.outer; i < faces.count(0.1); ++i) {
        double x = 0;
        for (const Index p : faces.faces[i].corner) x += mesh.points[p].position.x / 3;
        left += x < 0.5 ? 1 : 0;
    }
    // Half of them, within four standard deviations of a binomial distribution.
    EXPECT_NEAR(static_cast<double>(left), 0.5 * static_cast<double>(tenth), 2 * std::sqrt(static_cast<double>(tenth)));
}

TEST(TetFaces, CentroidsGoFromFrontToBack) {
    const TetMesh mesh = split(test::jittered_box(5, 0.3, 7));
    const TetFaces faces = find_faces(mesh);
    const View view({.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .fovy_deg = 35}, 8, 8);
    const std::size_t count = faces.count(0.5);
    const auto order = order_faces(mesh, faces, count, view);
    ASSERT_EQ(order.size(), count);
    EXPECT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), count);
    double last = 0;
    for (const std::uint32_t i : order) {
        ASSERT_LT(i, count);
        Vec3 sum(0.0);
        for (const Index p : faces.faces[i].corner) sum += mesh.points[p].position;
        const double depth = view.to_eye(sum / 3.0).z;
        EXPECT_GE(depth, last - 1e-6);  // sorted in single precision
        last = depth;
    }
}

TEST(TetFaces, IsTheSameForAnyNumberOfThreads) {
    const TetMesh mesh = split(test::jittered_box(6, 0.9, 7));
    const View view({.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .ortho_height = 2}, 8, 8);
    const auto find = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const TetFaces faces = find_faces(mesh);
        std::vector<std::uint32_t> all = order_faces(mesh, faces, faces.faces.size(), view);
        for (const auto& face : faces.faces)
            all.insert(all.end(), {face.corner[0], face.corner[1], face.corner[2], face.cover});
        return all;
    };
    EXPECT_EQ(find(1), find(4));
}

TEST(TetFaces, ValuesInsideAreLinear) {
    const HexMesh hexes = test::jittered_box(4, 0.2, 3);
    const auto field = [](const Vec3& p) { return 2 * p.x - p.y + 0.5 * p.z; };
    const TetMesh mesh = build_tet_mesh(hexes, test::evaluate(hexes, field));
    for (const Vec3& p : {Vec3(0.43, 0.37, 0.52), Vec3(0.01, 0.99, 0.5), Vec3(0.25, 0.25, 0.25), Vec3(1.001, 0.5, 0.3)})
        EXPECT_NEAR(value_at(mesh, p), field(p), 1e-12);
}

}  // namespace tet_faces_test
}  // namespace subvol
