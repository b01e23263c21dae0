// SPDX-License-Identifier: Apache-2.0
#include "surface_bodies.h"

#include <gmock/gmock.h>

#include <functional>
#include <numbers>
#include <random>

#include "lib/make/shape/shapes.h"
#include "lib/test_meshes.h"

namespace subvol {
namespace surface_bodies_test {

using detail::SurfaceBodies;

Surface box(const Vec3& lower, const Vec3& upper) {
    Surface made = boundary_surface(test::make_box(1, 1, 1));
    for (Vec3& x : made.points) x = lower + x * (upper - lower);
    return made;
}

Surface turned_inwards(Surface surface) {
    for (auto& t : surface.triangles) std::swap(t[1], t[2]);
    return surface;
}

Surface joined(const std::vector<Surface>& parts) {
    Surface all;
    for (const Surface& part : parts) {
        const auto first = static_cast<Index>(all.points.size());
        all.points.insert(all.points.end(), part.points.begin(), part.points.end());
        for (const auto& t : part.triangles) all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    return all;
}

bool in_box(const Vec3& x, const Vec3& lower, const Vec3& upper) {
    return glm::all(glm::greaterThan(x, lower)) && glm::all(glm::lessThan(x, upper));
}

/// Compares what is inside with a closed form at 2,000 places, but for those that are nearer to the walls than coarse spheres
/// are to round ones: such have both answers within 0.02.
void expect_inside(const SurfaceBodies& bodies, const std::function<bool(const Vec3&)>& inside) {
    std::mt19937 dice(5);
    std::uniform_real_distribution<double> in(-2.2, 2.2);
    for (int k = 0; k < 2000; ++k) {
        const Vec3 x(in(dice), in(dice), in(dice));
        bool clear = true;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double off : {-0.02, 0.02}) {
                Vec3 near = x;
                near[axis] += off;
                clear = clear && inside(near) == inside(x);
            }
        }
        if (clear) {
            EXPECT_EQ(bodies.likeness(x) > 0.5F, inside(x)) << x.x << " " << x.y << " " << x.z;
        }
    }
}

TEST(SurfaceBodies, WallsWithinWallsAreThoseOfCavitiesWhateverTheirOrientation) {
    const Surface outer = test::sphere(16, 2), inner = test::sphere(16, 1.5), core = test::sphere(16, 0.8);
    const auto shell = [](const Vec3& x) {
        const double r = glm::length(x);
        return r < 2 && (r > 1.5 || r < 0.8);
    };
    const SurfaceBodies alike(joined({outer, inner, core}));
    expect_inside(alike, shell);
    EXPECT_EQ(alike.report().walls, 3U);
    EXPECT_EQ(alike.report().cavities, 1U);
    EXPECT_EQ(alike.report().cavities_alike, 1U);
    EXPECT_NEAR(alike.least_volume(), 4 * std::numbers::pi / 3 * (8 - 3.375 + 0.512), 0.2);
    const SurfaceBodies turned(joined({core, turned_inwards(inner), outer}));
    expect_inside(turned, shell);
    EXPECT_EQ(turned.report().cavities, 1U);
    EXPECT_EQ(turned.report().cavities_alike, 0U);
}

TEST(SurfaceBodies, CrossingWallsAreUnited) {
    // Beams of which no corner lies in another one, and a cavity in one of them.
    const Surface beam = box({-2, -.5, -.5}, {2, .5, .5}), across = box({-.4, -2, -.4}, {.4, 2, .4});
    const Surface cavity = test::sphere(12, 0.2);
    Surface moved = cavity;
    for (Vec3& x : moved.points) x.x += 1.2;
    const SurfaceBodies bodies(joined({beam, turned_inwards(across), moved}));
    expect_inside(bodies, [](const Vec3& x) {
        return (in_box(x, {-2, -.5, -.5}, {2, .5, .5}) && glm::distance(x, Vec3(1.2, 0, 0)) > 0.2) ||
               in_box(x, {-.4, -2, -.4}, {.4, 2, .4});
    });
    EXPECT_EQ(bodies.report().united, 1U);
    EXPECT_EQ(bodies.report().cavities, 1U);
    // Boxes that only touch, which makes no difference between their union and both.
    const SurfaceBodies touching(joined({box({0, 0, 0}, {1, 1, 1}), box({1, .2, .2}, {2, .7, .7})}));
    expect_inside(touching, [](const Vec3& x) {
        return in_box(x, {0, 0, 0}, {1, 1, 1}) || in_box(x, {1, .2, .2}, {2, .7, .7});
    });
}

TEST(SurfaceBodies, TrianglesAreTurnedAndCopiesAndFinsLeftOut) {
    Surface surface = box({-1, -1, -1}, {1, 1, 1});
    const std::size_t whole = surface.triangles.size();
    std::swap(surface.triangles[3][0], surface.triangles[3][1]);
    std::swap(surface.triangles[8][0], surface.triangles[8][1]);
    surface.triangles.push_back(surface.triangles[5]);
    // a fin on the edge of the first triangle
    const auto [a, b, c] = surface.triangles[0];
    surface.points.push_back(2.0 * surface.points[a]);
    surface.triangles.push_back({a, b, static_cast<Index>(surface.points.size() - 1)});
    const SurfaceBodies bodies(surface);
    EXPECT_EQ(bodies.surface().triangles.size(), whole);
    EXPECT_EQ(bodies.report().turned, 2U);
    EXPECT_EQ(bodies.report().copies, 1U);
    EXPECT_EQ(bodies.report().sheets, 1U);
    expect_inside(bodies, [](const Vec3& x) { return in_box(x, {-1, -1, -1}, {1, 1, 1}); });
    EXPECT_EQ(detail::open_edges(surface).count, 2U);
}

TEST(SurfaceBodies, ASheetEnclosesNothing) {
    Surface sheet = box({-1, -1, -1}, {1, 1, 1});
    sheet.triangles.resize(2);
    EXPECT_TRUE(SurfaceBodies(sheet).is_sheet());
    Surface open = box({-1, -1, -1}, {1, 1, 1});
    open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 2);
    EXPECT_FALSE(SurfaceBodies(open).is_sheet());
    EXPECT_EQ(detail::open_edges(open).count, 4U);
    EXPECT_NEAR(detail::open_edges(open).length_world, 8, 1e-12);
}

}  // namespace surface_bodies_test
}  // namespace subvol
