// SPDX-License-Identifier: Apache-2.0
#include "tet_order.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>

#include "gl_tet_lists.h"
#include "render/hex_meshes.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;
namespace tet_order_test {

TetMesh split(const HexMesh& mesh) {
    return build_tet_mesh(mesh, std::vector<double>(mesh.points.size(), 1.0));
}

View perspective() {
    return {{.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .fovy_deg = 35}, 8, 8};
}
View orthographic() {
    return {{.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .ortho_height = 2}, 8, 8};
}
View inside() {
    return {{.eye = {0.43, 0.37, 0.52}, .target = {0.9, 0.8, 0.3}, .up = {0, 0, 1}}, 8, 8};
}

/// The position of every tetrahedron; checks that each occurs once.
std::vector<std::size_t> places(const TetOrder& order, std::size_t count) {
    std::vector<std::size_t> result(count, count);
    EXPECT_EQ(order.tets.size(), count);
    for (std::size_t i = 0; i < order.tets.size(); ++i) result[order.tets[i]] = i;
    EXPECT_EQ(std::ranges::count(result, count), 0);
    return result;
}

/// Whether a point of a tetrahedron lies on the eye's side of a face.
double side(const TetMesh& mesh, TetFace face, const Vec3& direction_from_face) {
    const auto ids = mesh.corners(face);
    const Vec3& p = mesh.points[ids[0]].position;
    return dot(cross(mesh.points[ids[1]].position - p, mesh.points[ids[2]].position - p), direction_from_face);
}

std::size_t wrong_faces(const TetMesh& mesh, const TetOrder& order, const View& view) {
    const auto at = places(order, mesh.tets.size());
    std::size_t wrong = 0;
    for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
        for (std::uint32_t k = 0; k < 4; ++k) {
            const Index other = mesh.neighbor(t, k);
            if (other == kNone) continue;
            const Vec3& p = mesh.points[mesh.corners(4 * t + k)[0]].position;
            const Vec3 eye = view.perspective() ? view.eye() - p : -view.axes()[2];
            const double mine = side(mesh, 4 * t + k, mesh.points[mesh.tets[t].corner[k]].position - p);
            const bool other_is_nearer = side(mesh, 4 * t + k, eye) * mine < -1e-12;
            wrong += other_is_nearer && at[other] < at[t] ? 1 : 0;
        }
    }
    return wrong;
}

TEST(TetOrder, WhatIsBehindASharedFaceComesFirst) {
    for (const HexMesh& hexes : {test::box(3), test::jittered_box(5, 0.3, 7), test::ball(4), test::l_shape(4)}) {
        const TetMesh mesh = split(hexes);
        for (const View& view : {perspective(), orthographic(), inside()}) {
            const TetOrder order = order_topologically(mesh, view);
            EXPECT_EQ(order.cycles, 0u);
            EXPECT_EQ(wrong_faces(mesh, order, view), 0u);
        }
    }
    const TetMesh mesh = split(test::jittered_box(5, 0.3, 7));
    EXPECT_GT(wrong_faces(mesh, order_by_centroid(mesh, perspective()), perspective()), 0u) << "otherwise the test is void";
}

TEST(TetOrder, CentroidsGoFromBackToFront) {
    const TetMesh mesh = split(test::jittered_box(4, 0.3, 7));
    const View view = perspective();
    const auto order = order_by_centroid(mesh, view).tets;
    double last = 1e300;
    for (const auto t : order) {
        Vec3 sum(0.0);
        for (const Index p : mesh.tets[t].corner) sum += mesh.points[p].position;
        const double depth = view.to_eye(0.25 * sum).z;
        EXPECT_LE(depth, last);
        last = depth;
    }
}

TEST(TetOrder, EveryTetrahedronComesOnceWhereCellsFoldOver) {
    // Points are moved by more than a cell: no order is right, but the work has to end.
    const TetMesh mesh = split(test::jittered_box(6, 1.5, 3));
    EXPECT_GT(mesh.shapes.inverted, 0u);
    const TetOrder order = order_topologically(mesh, perspective());
    (void)places(order, mesh.tets.size());
    EXPECT_GT(order.cycles, 0u);
}

TEST(TetOrder, IsTheSameForAnyNumberOfThreads) {
    const TetMesh mesh = split(test::jittered_box(8, 0.3, 7));
    const auto both = [&] {
        return std::pair{order_by_centroid(mesh, perspective()).tets, order_topologically(mesh, perspective()).tets};
    };
    const auto many = both();
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(both(), many);
}

TEST(ListParts, HoldEveryPixelOnceAndNoMoreThanTheyMay) {
    constexpr int kWidth = 13, kHeight = 9;
    std::vector<std::uint32_t> counts(kWidth * kHeight);
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = static_cast<std::uint32_t>(i * i % 17);
    counts[60] = 40;
    for (const std::size_t most : {40U, 41U, 100U, 150U, 400U, 100000U}) {
        std::vector<int> seen(counts.size());
        for (const auto& part : detail::split_into_parts(counts, kWidth, kHeight, most)) {
            std::size_t sum = 0;
            for (int y = part.y0; y < part.y1; ++y) {
                for (int x = part.x0; x < part.x1; ++x) {
                    const auto pixel = static_cast<std::size_t>(y * kWidth + x);
                    ++seen[pixel];
                    sum += counts[pixel];
                }
            }
            EXPECT_LE(sum, most);
        }
        EXPECT_EQ(std::ranges::count(seen, 1), kWidth * kHeight) << most;
    }
    EXPECT_THROW((void)detail::split_into_parts(counts, kWidth, kHeight, 39), Error);
}

}  // namespace tet_order_test
}  // namespace subvol
