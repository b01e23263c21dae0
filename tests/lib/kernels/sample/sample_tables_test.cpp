// SPDX-License-Identifier: Apache-2.0
#include "subvol/sample_tables.h"

#include <gtest/gtest.h>

#include <cmath>

#include "subvol/error.h"
#include "subvol/model.h"

namespace subvol {
namespace sample_tables_test {

HexMesh twisted(HexMesh mesh, double angle) {
    for (Vec3& p : mesh.points) {
        const double a = angle * p.z;
        p = {std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y, p.z};
    }
    for (double& value : mesh.attributes.front().values) value = 0.5 * value + angle;
    return mesh;
}

TEST(SampleTables, GiveTheKernelsOfAMeshThatMoved) {
    for (const Scheme scheme : {Scheme::Mcq, Scheme::Linear}) {
        const HexMesh mesh = make_model("ball", 4);  // with singular points and edges of three cells
        const SampleOptions options{.scheme = {.kind = scheme}};
        const SampleTables tables(mesh, options);
        for (const double angle : {0.0, 0.4}) {
            const HexMesh moved = twisted(mesh, angle);
            const RbfVolume quick = tables.apply(moved).volume, whole = sample_rbf_points(moved, options).volume;
            EXPECT_EQ(quick.centers, whole.centers);
            EXPECT_EQ(quick.frames, whole.frames);
            EXPECT_EQ(quick.channels[0].values, whole.channels[0].values);
            EXPECT_EQ(quick.channels[0].gradients, whole.channels[0].gradients);
            EXPECT_EQ(quick.channels[0].moments, whole.channels[0].moments);
            ASSERT_EQ(quick.boundary.triangles.size(), whole.boundary.triangles.size());
            // Its points may have other numbers: its area and the volume inside say whether it is the same.
            const auto inside = [](const Surface& surface) {
                double volume = 0;
                for (const auto& [a, b, c] : surface.triangles)
                    volume += glm::dot(surface.points[a], glm::cross(surface.points[b], surface.points[c])) / 6;
                return volume;
            };
            EXPECT_NEAR(inside(quick.boundary), inside(whole.boundary), 1e-10);
            EXPECT_NEAR(glm::distance(quick.bounds.upper, whole.bounds.upper), 0, 1e-12);
        }
    }
}

TEST(SampleTables, AreForOneKernelAtEachControlPoint) {
    const HexMesh mesh = make_model("ball", 2);
    EXPECT_TRUE(SampleTables::are_for({}));
    for (const SampleOptions& options : {SampleOptions{.per_edge = 2}, SampleOptions{.spacing_world = 0.1},
                                         SampleOptions{.scheme = {.kind = Scheme::CatmullClark}}}) {
        EXPECT_FALSE(SampleTables::are_for(options));
        EXPECT_THROW(SampleTables(mesh, options), Error);
    }
    const SampleTables tables(mesh, {});
    EXPECT_THROW((void)tables.apply(make_model("ball", 3)), Error);
}

}  // namespace sample_tables_test
}  // namespace subvol
