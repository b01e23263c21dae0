// SPDX-License-Identifier: Apache-2.0
// Where rays are inside a surface that is closed but folds, against the winding number of places, by solid angles.
#include "boundary_intervals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lib/random_vector.h"
#include "lib/test_meshes.h"

namespace subvol {
namespace boundary_intervals_test {

using detail::boundary_intervals;
using detail::PixelIntervals;

constexpr double kNear = .01;

/// How often a closed surface goes round a place: its solid angle there, A. van Oosterom and J. Strackee (1983), over 4π.
int winding(const Surface& surface, const Vec3& place) {
    double angle = 0;
    for (const auto& t : surface.triangles) {
        const Vec3 a = surface.points[t[0]] - place, b = surface.points[t[1]] - place, c = surface.points[t[2]] - place;
        const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
        angle += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return static_cast<int>(std::lround(angle / (4 * M_PI)));
}

View along_y(int size, double height) {
    return View({.eye = {.5, -4, .5}, .target = {.5, 0, .5}, .up = {0, 0, 1}, .ortho_height = height}, size, size);
}

std::vector<float> depths_of(const PixelIntervals& intervals, std::size_t pixel) {
    return {intervals.depths.begin() + 2 * intervals.offsets[pixel],
            intervals.depths.begin() + 2 * intervals.offsets[pixel + 1]};
}

TEST(BoundaryIntervals, APartThatIsTurnedInsideOutIsInside) {
    Surface surface = boundary_surface(test::make_box(1, 1, 1));
    for (Vec3& p : surface.points) p.y = 1 - p.y;  // mirrored: rays leave it before they enter it
    const Surface box = boundary_surface(test::make_box(1, 1, 1));
    const auto first = static_cast<Index>(surface.points.size());
    for (const Vec3& p : box.points) surface.points.push_back(p + Vec3(0, 1, 0));
    for (const auto& t : box.triangles) surface.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    const PixelIntervals found = boundary_intervals(surface, along_y(9, .9), kNear, 0);
    for (std::size_t pixel = 0; pixel < 81; ++pixel) {
        const auto depths = depths_of(found, pixel);
        ASSERT_EQ(depths.size(), 4U);
        for (const auto& [k, depth] : {std::pair{0U, 4.0}, {1U, 5.0}, {2U, 5.0}, {3U, 6.0}})
            EXPECT_NEAR(depths[k], depth, 1e-5);
    }
}

// At a silhouette roundings decide which of two sides comes first. That is no part that is turned inside out.
TEST(BoundaryIntervals, SidesInTheWrongOrderByRoundingsAreNoBody) {
    for (const auto& [thickness, intervals] : {std::pair{1e-6, 0U}, {1e-4, 25U}}) {
        Surface surface = boundary_surface(test::make_box(1, 1, 1));
        for (Vec3& p : surface.points) p.y *= -thickness;
        EXPECT_EQ(boundary_intervals(surface, along_y(5, .5), kNear, 0).triangles.size(), intervals) << thickness;
        for (Vec3& p : surface.points) p.y *= -1;
        const std::size_t thin = boundary_intervals(surface, along_y(5, .5), kNear, 0).triangles.size();
        EXPECT_EQ(thin, 25U) << "the body itself, however thin";
    }
}

TEST(BoundaryIntervals, RaysAreInsideWhereACrumpledSurfaceGoesRoundThem) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shift(-.6, .6);
    Surface surface = boundary_surface(test::make_box(3, 3, 3));
    for (Vec3& p : surface.points) p = p / 3.0 + test::random_vector(shift, random);
    const View view = along_y(24, 1.6);
    const PixelIntervals found = boundary_intervals(surface, view, kNear, 0);
    int negative = 0, inside = 0;
    for (int pixel = 0; pixel < 24 * 24; ++pixel) {
        const Ray ray = view.ray(pixel % 24 + .5, pixel / 24 + .5);
        const auto depths = depths_of(found, static_cast<std::size_t>(pixel));
        for (double depth = 2.4; depth < 6.7; depth += .0837) {
            double nearest = 1;  // an end's place is right to the rounding of floats, and that of corners to 1/4096 px
            bool in = false;
            for (std::size_t i = 0; i < depths.size(); i += 2) {
                in = in || (depth > double{depths[i]} && depth < double{depths[i + 1]});
                nearest = std::min({nearest, std::abs(depth - double{depths[i]}), std::abs(depth - double{depths[i + 1]})});
            }
            if (nearest < .01) continue;
            const int times = winding(surface, ray.origin + depth / glm::length(ray.direction) * ray.direction);
            ASSERT_EQ(in, times != 0) << pixel << " at " << depth;
            negative += times < 0 ? 1 : 0;
            inside += in ? 1 : 0;
        }
    }
    EXPECT_GT(inside, 1000);
    EXPECT_GT(negative, 100) << "the surface folds";
}

TEST(BoundaryIntervals, TheEyeMayBeInAPartThatIsTurnedInsideOut) {
    Surface surface = boundary_surface(test::make_box(1, 1, 1));
    for (Vec3& p : surface.points) p = {4 * p.x - 2, -4 + 3 * (1 - p.y) - 1, 4 * p.z - 2};  // y from −5 to −2; the eye is at −4
    const PixelIntervals found = boundary_intervals(surface, along_y(5, .5), kNear, 0);
    const auto depths = depths_of(found, 12);
    ASSERT_EQ(depths.size(), 2U);
    EXPECT_NEAR(depths[0], kNear, 1e-6);
    EXPECT_NEAR(depths[1], 2, 1e-5);
    EXPECT_EQ(found.triangles[found.offsets[12]], PixelIntervals::kNoTriangle);
}

}  // namespace boundary_intervals_test
}  // namespace subvol
