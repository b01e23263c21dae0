// SPDX-License-Identifier: Apache-2.0
#include "subvol/boundary_values.h"

#include <gtest/gtest.h>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/model.h"

namespace subvol {
namespace boundary_values_test {

TEST(BoundaryValues, AreThoseOfALinearField) {
    HexMesh mesh = test::make_box(3, 2, 4);
    Attribute field{"a", 1, {}};
    for (const Vec3& p : mesh.points) field.values.push_back(p.x + 10 * p.y - 3 * p.z);
    mesh.attributes = {field};
    for (const int levels : {0, 1, 2}) {
        const BoundaryValues boundary = boundary_values(mesh, {.levels = levels});
        ASSERT_EQ(boundary.values.size(), 1u);
        ASSERT_EQ(boundary.values[0].size(), boundary.surface.points.size());
        EXPECT_EQ(boundary.surface.triangles.size(), 2u * 52u << (2 * levels)) << "two for each of the 52 quads";
        for (std::size_t i = 0; i < boundary.surface.points.size(); ++i) {
            const Vec3& p = boundary.surface.points[i];
            EXPECT_NEAR(boundary.values[0][i], p.x + 10 * p.y - 3 * p.z, 1e-12);
        }
    }
}

TEST(BoundaryValues, BodiesThatTouchKeepTheirOwn) {
    HexMesh mesh = test::make_box(1, 1, 1);
    const HexMesh other = mesh;
    for (const Vec3& p : other.points) mesh.points.push_back(p + Vec3(1, 0, 0));
    mesh.cells.push_back(mesh.cells[0]);
    for (Index& corner : mesh.cells[1]) corner += 8;
    mesh.attributes = {{"a", 1, std::vector<double>(16, 1.0)}};
    std::fill(mesh.attributes[0].values.begin() + 8, mesh.attributes[0].values.end(), 5.0);
    const BoundaryValues boundary = boundary_values(mesh, {.levels = 1});
    for (const auto& triangle : boundary.surface.triangles) {
        Vec3 middle(0.0);
        for (const Index corner : triangle) middle += boundary.surface.points[corner] / 3.0;
        if (middle.x == 1) continue;  // where they touch
        for (const Index corner : triangle) EXPECT_EQ(boundary.values[0][corner], middle.x < 1 ? 1 : 5);
    }
}

TEST(BoundaryValues, NeedScalars) {
    HexMesh mesh = test::make_box(1, 1, 1);
    mesh.attributes = {{"v", 3, std::vector<double>(24)}};
    test::expect_error(ErrorCode::InvalidInput, "field v", [&] { (void)boundary_values(mesh, {.levels = 1}); });
    mesh.attributes.clear();
    test::expect_error(ErrorCode::InvalidInput, "level", [&] { (void)boundary_values(mesh, {.levels = -1}); });
}

TEST(BoundaryTables, FollowAMeshThatMoves) {
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        for (const int levels : {0, 1, 2}) {
            HexMesh mesh = make_model("ball", 3);
            const RefineOptions options{.scheme = {.kind = scheme}, .levels = levels};
            const BoundaryTables tables(mesh, options);
            for (Vec3& p : mesh.points) p = {p.x + 0.2 * p.z * p.z, 1.5 * p.y, p.z - 0.1 * p.x};
            for (double& value : mesh.attributes.front().values) value = value * value + 1;
            const BoundaryValues moved = tables.apply(mesh), anew = boundary_values(mesh, options);
            ASSERT_EQ(moved.surface.triangles, anew.surface.triangles);
            ASSERT_EQ(moved.surface.points.size(), anew.surface.points.size());
            for (std::size_t p = 0; p < moved.surface.points.size(); ++p) {
                EXPECT_NEAR(glm::distance(moved.surface.points[p], anew.surface.points[p]), 0, 1e-12);  // rounding
                EXPECT_NEAR(moved.values[0][p], anew.values[0][p], 1e-12);
            }
        }
    }
}

}  // namespace boundary_values_test
}  // namespace subvol
