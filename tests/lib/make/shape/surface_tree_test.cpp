// SPDX-License-Identifier: Apache-2.0
#include "surface_tree.h"

#include <gtest/gtest.h>

#include <random>

#include "lib/make/shape/shapes.h"
#include "subvol/detail/triangle_distance.h"

namespace subvol {
namespace surface_tree_test {

std::vector<Vec3> places(std::size_t count, double reach) {
    std::mt19937 dice(7);
    std::uniform_real_distribution<double> at(-reach, reach);
    std::vector<Vec3> made(count);
    for (Vec3& x : made) x = {at(dice), at(dice), at(dice)};
    return made;
}

TEST(NearestInTriangle, IsTheNearestOfManyPlacesInIt) {
    const Vec3 a(0, 0, 0), b(1, .1, 0), c(.2, .9, .3);
    for (const Vec3& x : places(200, 2)) {
        const detail::NearestInTriangle found = detail::nearest_in_triangle(x, a, b, c);
        EXPECT_NEAR(found.weights.x + found.weights.y + found.weights.z, 1, 1e-12);
        const double distance = glm::distance(x, found.weights.x * a + found.weights.y * b + found.weights.z * c);
        EXPECT_NEAR(distance * distance, detail::squared_distance(x, a, b, c), 1e-12);
        constexpr int kSteps = 40;
        for (int i = 0; i <= kSteps; ++i) {
            for (int j = 0; i + j <= kSteps; ++j) {
                const double u = double(i) / kSteps, v = double(j) / kSteps;
                EXPECT_LE(distance, glm::distance(x, a + u * (b - a) + v * (c - a)) + 1e-12);
            }
        }
    }
}

TEST(NearestInTriangle, OfOneWithoutAreaIsOnItsEdges) {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(2, 0, 0);
    EXPECT_NEAR(detail::squared_distance({1.5, 1, 0}, a, b, c), 1, 1e-12);
    EXPECT_NEAR(detail::squared_distance({3, 0, 0}, a, b, c), 1, 1e-12);
    EXPECT_NEAR(detail::squared_distance({-1, 0, 1}, a, a, a), 2, 1e-12);
}

TEST(SurfaceTree, FindsTheNearestOfAllTriangles) {
    const Surface surface = test::sphere(5);
    const detail::SurfaceTree tree(surface);
    for (const Vec3& x : places(300, 1.5)) {
        double least = INFINITY;
        for (const auto& t : surface.triangles) {
            least =
                std::min(least, detail::squared_distance(x, surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]));
        }
        const detail::SurfacePlace found = tree.nearest(x);
        EXPECT_NEAR(found.distance * found.distance, least, 1e-12);
        EXPECT_NEAR(glm::distance(x, found.point + found.distance * found.toward), 0, 1e-9);
    }
}

TEST(SurfaceTree, OnTheSurfaceTheDirectionIsTheNormal) {
    const Surface surface = test::moved_box(2, [](const Vec3& x) { return x; });
    const detail::SurfacePlace found = detail::SurfaceTree(surface).nearest({1, .3, .2});
    EXPECT_EQ(found.distance, 0);
    EXPECT_EQ(found.toward, Vec3(1, 0, 0));
}

TEST(SurfaceTree, TheWindingNumberIsOneInsideAndZeroOutside) {
    Surface surface = test::sphere(8);
    const detail::SurfaceTree tree(surface);
    for (const Vec3& x : places(300, 1.5)) {
        const double distance = glm::length(x);
        if (std::abs(distance - 1) > 0.05) {
            EXPECT_NEAR(tree.winding(x), distance < 1 ? 1 : 0, 0.02) << x.x << ' ' << x.y << ' ' << x.z;
        }
    }
    surface.triangles.erase(surface.triangles.begin(), surface.triangles.begin() + 4);  // a hole
    EXPECT_GT(detail::SurfaceTree(surface).winding({0, 0, 0}), 0.9);
}

}  // namespace surface_tree_test
}  // namespace subvol
