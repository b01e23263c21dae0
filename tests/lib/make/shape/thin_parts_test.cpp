// SPDX-License-Identifier: Apache-2.0
#include "thin_parts.h"

#include <gmock/gmock.h>

#include <cmath>

#include "lib/make/shape/shapes.h"
#include "lib/test_meshes.h"
#include "subvol/control_mesh.h"
#include "subvol/surface.h"

namespace subvol::detail {

namespace thin_parts_test {

using testing::HasSubstr;

Surface plate(const Vec3& size) {
    Surface surface = boundary_surface(test::make_box(1, 1, 1));
    const Box box = bounds(surface);
    for (Vec3& x : surface.points) x = (x - box.lower) / box.size() * size;
    return surface;
}

void turn(Surface& surface) {
    const double c = std::cos(0.7), s = std::sin(0.7);
    for (Vec3& x : surface.points) x = Vec3(c * x.x - s * x.z, x.y, s * x.x + c * x.z) + Vec3(3, -2, 7);
}

// The two large sides of a plate bound what is thin; its rim does not, as the other rim is far.
TEST(ThinParts, OfAPlateAreItsTwoSides) {
    for (const Vec3& size : {Vec3(1, 1, 0.05), Vec3(1, 0.5, 0.02), Vec3(0.3, 2, 3)}) {
        const double t = std::min({size.x, size.y, size.z});
        const double all = 2 * (size.x * size.y + size.y * size.z + size.z * size.x), sides = 2 * size.x * size.y * size.z / t;
        for (const bool turned : {false, true}) {
            for (const bool inside_out : {false, true}) {
                Surface surface = plate(size);
                if (turned) turn(surface);
                if (inside_out) {
                    for (auto& triangle : surface.triangles) std::swap(triangle[0], triangle[1]);
                }
                const SurfaceBodies bodies(surface);
                const ThinParts thin = thin_parts(bodies, 1.3 * t);
                EXPECT_NEAR(thin.part, sides / all, 1e-9) << turned;
                EXPECT_NEAR(thin.thickness_world, t, 1e-9 * t) << turned;
                EXPECT_EQ(thin_parts(bodies, 0.9 * t).part, 0);
            }
        }
    }
}

// The wall of a hollow sphere of the radii .9 and 1. By directions at right angles to it all of it is .1 thick.
TEST(ThinParts, OfAHollowSphereAreAllOfIt) {
    Surface hollow = test::sphere(24);
    const Surface inner = hollow;
    for (Vec3& x : hollow.points) x = glm::normalize(x);
    const auto first = static_cast<Index>(hollow.points.size());
    for (const Vec3& x : inner.points) hollow.points.push_back(0.9 * glm::normalize(x));
    for (const auto& [a, b, c] : inner.triangles) hollow.triangles.push_back({first + a, first + b, first + c});
    const ThinParts thin = thin_parts(SurfaceBodies(hollow), 0.15);
    EXPECT_NEAR(thin.part, 1, 1e-9);
    EXPECT_NEAR(thin.thickness_world, 0.1, 2e-3);
    EXPECT_NEAR(glm::length(thin.at), 0.95, 0.06);
    // A ball has no thin part, nor has what is between two walls outside of a body.
    EXPECT_EQ(thin_parts(SurfaceBodies(test::sphere(24)), 0.5).part, 0);
}

TEST(ThinParts, AreSaidWithTheNumberOfCellsThatWouldDo) {
    const Surface thin = plate({1, 0.5, 0.25});
    const ControlMesh made = control_mesh_of(thin, {.cells = 4, .folds = {.keep = true}});
    EXPECT_NEAR(made.report.thin.value().thickness_world, 0.25, 1e-9);
    EXPECT_THAT(made.report.shape.warnings.back(),
                HasSubstr("57 % of the surface bounds parts that are thinner than 1.5 cells, such as 0.25 at"));
    EXPECT_THAT(made.report.shape.warnings.back(), HasSubstr(": cells 8 has two across them"));
    // With as many cells nothing is wrong, and nothing is said.
    const ControlMesh better = control_mesh_of(thin, {.cells = 8});
    EXPECT_TRUE(better.report.shape.is_sound());
    EXPECT_EQ(better.report.sharp.missed, 0u);
    EXPECT_NEAR(better.report.shape.volume_world / (0.5 * 0.25), 1, 0.02);
    EXPECT_FALSE(better.report.thin);
    EXPECT_TRUE(better.report.shape.warnings.empty());
}

}  // namespace thin_parts_test

}  // namespace subvol::detail
