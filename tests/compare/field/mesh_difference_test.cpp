// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "subvol/error.h"
#include "vdb/test_meshes.h"

namespace subvol {
namespace mesh_difference_test {

double linear(const Vec3& x) {
    return .4 + 1.5 * x.x - 2 * x.y + .7 * x.z;
}

TEST(MeshDifference, PointByPointOfOneMesh) {
    HexMesh reference = test::with_field(test::box_mesh(2), "f", linear), changed = reference;
    changed.attributes[0].values[5] -= 3;
    changed.attributes.push_back({"only here", 1, std::vector<double>(changed.points.size(), 1.0)});
    const MeshDifference found = mesh_difference(changed, reference);
    EXPECT_TRUE(found.same_points);
    EXPECT_EQ(found.outside, 0u);
    ASSERT_EQ(found.mesh.attributes.size(), 1u);
    for (std::size_t p = 0; p < changed.points.size(); ++p)
        EXPECT_NEAR(found.mesh.attributes[0].values[p], p == 5 ? -3 : 0, 1e-15);
    ASSERT_EQ(found.fields.size(), 1u);
    EXPECT_EQ(found.fields[0].name, "f");
    EXPECT_NEAR(found.fields[0].max, 3, 1e-15);
    EXPECT_EQ(found.fields[0].point, 5u);
    EXPECT_EQ(found.fields[0].place, changed.points[5]);
}

TEST(MeshDifference, ValuesAtCellsOfOneMesh) {
    HexMesh mesh = test::with_field(test::box_mesh(2), "f", linear);
    mesh.attributes[0].cells.assign(mesh.cells.size(), 1.0);
    mesh.attributes[0].constant = true;
    HexMesh other = mesh;
    other.attributes[0].cells[3] = .25;
    const MeshDifference found = mesh_difference(mesh, other);
    EXPECT_TRUE(found.mesh.attributes[0].constant);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) EXPECT_EQ(found.mesh.attributes[0].cells[c], c == 3 ? .75 : 0);
    // Means at points would hide it. Cell 3 is that of the upper halves of x and y and the lower one of z.
    EXPECT_EQ(found.fields[0].max, .75);
    EXPECT_EQ(found.fields[0].cell, 3u);
    EXPECT_FALSE(found.fields[0].point);
    EXPECT_EQ(found.fields[0].place, Vec3(0.75, 0.75, 0.25));
}

TEST(MeshDifference, ALinearFieldOfAnotherMeshIsMetAtEveryPoint) {
    HexMesh test = test::with_field(test::box_mesh(3), "f", [](const Vec3& x) { return linear(x) + x.z * x.z; });
    test.attributes.push_back({"v", 3, {}});
    HexMesh reference = test::with_field(test::jittered_box_mesh(4), "f", linear);
    reference.attributes.push_back({"v", 3, {}});
    for (const Vec3& x : test.points)
        test.attributes[1].values.insert(test.attributes[1].values.end(), {x.x + 3, x.y - 4, x.z});
    for (const Vec3& x : reference.points)
        reference.attributes[1].values.insert(reference.attributes[1].values.end(), {x.x, x.y, x.z});
    const MeshDifference found = mesh_difference(test, reference);
    EXPECT_FALSE(found.same_points);
    for (std::size_t p = 0; p < test.points.size(); ++p) {
        const double z = test.points[p].z;
        EXPECT_NEAR(found.mesh.attributes[0].values[p], z * z, 1e-5);  // the limit is found to 1e-6 of the range
        EXPECT_NEAR(found.mesh.attributes[1].values[3 * p + 1], -4, 1e-5);
    }
    EXPECT_NEAR(found.fields[0].max, 1, 1e-5);
    EXPECT_NEAR(found.fields[0].place.z, 1, 1e-12);
    EXPECT_NEAR(found.fields[1].max, 5, 1e-5);  // the length of (3, -4, 0)
}

TEST(MeshDifference, OutsideTheNearestPlaceIsCompared) {
    // The half of the box beyond x = .5 lies outside: there the reference is that of x = .5.
    const HexMesh test = test::with_field(test::box_mesh(4), "f", linear);
    const HexMesh half = test::with_field(test::box_mesh(2, Vec3(0.0), Vec3(.5, 1, 1)), "f", linear);
    const MeshDifference found = mesh_difference(test, half);
    EXPECT_EQ(found.outside, 2u * 25);
    EXPECT_NEAR(found.outside_world, .5, 1e-5);
    for (std::size_t p = 0; p < test.points.size(); ++p)
        EXPECT_NEAR(found.mesh.attributes[0].values[p], 1.5 * std::max(0.0, test.points[p].x - .5), 1e-4);
}

TEST(MeshDifference, WhatHasNoDifference) {
    const HexMesh mesh = test::with_field(test::box_mesh(2), "f", linear);
    EXPECT_THROW((void)mesh_difference(mesh, test::with_field(test::box_mesh(2), "g", linear)), Error);
    HexMesh vector = test::box_mesh(2);
    vector.attributes.push_back({"f", 3, std::vector<double>(3 * vector.points.size(), 0.0)});
    EXPECT_THROW((void)mesh_difference(mesh, vector), Error);
}

}  // namespace mesh_difference_test
}  // namespace subvol
