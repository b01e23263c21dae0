// SPDX-License-Identifier: Apache-2.0
// Volumes whose cells touch in edges and points alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/limit.h"
#include "subvol/mesh_report.h"
#include "subvol/refine.h"
#include "subvol/topology.h"

namespace subvol {
namespace touching_bodies_test {

constexpr double kRounding = 1e-13;  // sums of some ten terms of size 1, a few levels deep

HexMesh with_field(HexMesh mesh) {
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(3 * p.x + p.y) + p.z * p.z; });
    return mesh;
}

/// The positions and values of both parts of a mesh are those of each part refined alone.
void expect_parts_alone(const HexMesh& both, std::size_t cells_of_first, const RefineOptions& options) {
    const auto limit = [&](const HexMesh& mesh) { return on_limit(refine(mesh, options), options.scheme.kind); };
    const HexMesh together = limit(both);
    HexMesh first = both, second = both;
    const auto split = static_cast<std::ptrdiff_t>(cells_of_first);
    first.cells.erase(first.cells.begin() + split, first.cells.end());
    second.cells.erase(second.cells.begin(), second.cells.begin() + split);
    std::size_t c = 0;
    for (const HexMesh& part : {limit(first), limit(second)}) {
        for (const auto& cell : part.cells) {
            for (std::size_t k = 0; k < 8; ++k) {
                const Index p = together.cells[c][k];
                ASSERT_LE(glm::distance(together.points[p], part.points[cell[k]]), 1e-12);
                ASSERT_NEAR(together.attributes[0].values[p], part.attributes[0].values[cell[k]], 1e-12);
            }
            ++c;
        }
    }
    EXPECT_EQ(c, together.cells.size());
}

/// Two boxes of n cells each way, the second moved, with their common points joined.
HexMesh two_boxes(Index n, const Vec3& step) {
    HexMesh mesh = test::make_box(n, n, n);
    const HexMesh other = mesh;
    std::vector<Index> number;
    for (const Vec3& p : other.points) {
        const auto found = std::ranges::find(mesh.points, p + step);
        number.push_back(static_cast<Index>(found - mesh.points.begin()));
        if (found == mesh.points.end()) mesh.points.push_back(p + step);
    }
    for (auto cell : other.cells) {
        for (Index& p : cell) p = number[p];
        mesh.cells.push_back(cell);
    }
    return with_field(std::move(mesh));
}

class TouchingBodies : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, TouchingBodies,
                         testing::Values(Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear));

TEST_P(TouchingBodies, BodiesThatTouchInAnEdgeOrAPointRefineAsEachAlone) {
    for (const Index n : {1u, 2u}) {
        const auto size = double(n);
        const HexMesh at_point = two_boxes(n, Vec3(size));
        const MeshReport report = inspect(at_point);
        EXPECT_EQ(report.nonmanifold_points, 1u);
        EXPECT_EQ(report.nonmanifold_edges, 0u);
        for (const int levels : {1, 2}) {
            expect_parts_alone(at_point, n * n * n, {.scheme = {GetParam()}, .levels = levels});
        }
    }
    for (const Index n : {1u, 2u, 3u}) {  // the common edge has n segments, along which the field is not linear
        HexMesh at_edge = two_boxes(n, {double(n), double(n), 0});
        EXPECT_EQ(inspect(at_edge).nonmanifold_edges, n);
        EXPECT_EQ(inspect(at_edge).nonmanifold_points, 0u);
        test::jitter(at_edge, .05, 5);
        for (const int levels : {1, 2}) expect_parts_alone(at_edge, n * n * n, {.scheme = {GetParam()}, .levels = levels});
    }
}

TEST_P(TouchingBodies, AnEdgeOfManyFansIsACurve) {
    // Three stacks of two cells about a common edge of two segments.
    HexMesh mesh;
    for (int k = 0; k <= 2; ++k) mesh.points.emplace_back(0, .2 * k * k, k);
    for (int fan = 0; fan < 3; ++fan) {
        const double angle = 2.1 * fan;
        const Vec3 u(std::cos(angle), std::sin(angle), 0), v(std::cos(angle + .9), std::sin(angle + .9), 0);
        const auto first = static_cast<Index>(mesh.points.size());
        for (Index k = 0; k <= 2; ++k) {
            for (const Vec3& step : {u, u + v, v}) mesh.points.push_back(mesh.points[k] + step);
        }
        for (Index k = 0; k < 2; ++k) {
            const Index a = first + 3 * k, b = a + 3;
            mesh.cells.push_back({k, a, a + 1, a + 2, k + 1, b, b + 1, b + 2});
        }
    }
    mesh = with_field(std::move(mesh));
    EXPECT_EQ(inspect(mesh).nonmanifold_edges, 2u);
    const HexMesh fine = on_limit(refine(mesh, {.scheme = {GetParam()}, .levels = 3}), GetParam());
    EXPECT_EQ(inspect(fine).nonmanifold_edges, 16u);
    const auto& p = mesh.points;
    const Vec3 middle = interpolates(GetParam()) ? p[1] : (p[0] + 4.0 * p[1] + p[2]) / 6.0;
    EXPECT_LE(glm::distance(fine.points[0], p[0]), kRounding);
    EXPECT_LE(glm::distance(fine.points[1], middle), 1e-12);  // eigenvectors are found to 1e-13
    EXPECT_LE(glm::distance(fine.points[2], p[2]), kRounding);
    EXPECT_EQ(inspect(fine).inverted_cells, 0u);
}

TEST(NonManifold, APointOnATouchingCurveIsACornerIfAnotherBodyTouchesItThere) {
    HexMesh mesh = two_boxes(2, {2, 2, 0});  // along x = y = 2; a third body at (2, 2, 1)
    const auto at = static_cast<Index>(std::ranges::find(mesh.points, Vec3(2, 2, 1)) - mesh.points.begin());
    const auto first = static_cast<Index>(mesh.points.size());
    const HexMesh third = test::make_box(1, 1, 1);
    std::array<Index, 8> cell{};
    for (std::size_t k = 0; k < 8; ++k) {
        const Index c = third.cells[0][k];
        cell[k] = c == 0 ? at : static_cast<Index>(first + c - 1);
    }
    for (std::size_t c = 1; c < 8; ++c) {
        const Vec3& x = third.points[c];
        mesh.points.emplace_back(2 + .3 * (x.x + x.y), 2 - 1.2 * x.x + .3 * x.y, 1 + .4 * x.z);
    }
    mesh.cells.push_back(cell);
    mesh.attributes.clear();
    const HexMesh limit = on_limit(refine(mesh, {.scheme = {Scheme::CatmullClark}, .levels = 2}), Scheme::CatmullClark);
    EXPECT_EQ(limit.points[at], mesh.points[at]);
}

TEST(NonManifold, AFaceOfThreeCellsIsRefused) {
    HexMesh mesh = test::make_box(2, 1, 1);
    const auto first = static_cast<Index>(mesh.points.size());
    for (const Vec3& p : {Vec3(2, 0, 1), Vec3(2, 1, 1), Vec3(2, 0, 2), Vec3(2, 1, 2)}) mesh.points.push_back(p);
    mesh.cells.push_back({1, first, first + 1, 4, 7, first + 2, first + 3, 10});
    test::expect_error(ErrorCode::InvalidInput, "at most two cells share a face", [&] { (void)refine(mesh); });
}

}  // namespace touching_bodies_test
}  // namespace subvol
