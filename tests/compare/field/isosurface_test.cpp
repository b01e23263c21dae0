// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "subvol/error.h"
#include "subvol/field_metrics.h"

namespace subvol {
namespace isosurface_test {

const Box kBox{Vec3(-1.0), Vec3(1.0)};

/// The distance from a point: its isosurfaces are spheres.
FieldView distance_from(const Vec3& center) {
    return {.value = [=](const Vec3& x) { return std::optional(glm::length(x - center)); }, .box = kBox};
}

/// Linear: its isosurfaces are planes.
FieldView along(const Vec3& normal) {
    const Box box = kBox;
    return {.value =
                [=](const Vec3& x) {
                    const Vec3 d = glm::abs(x);
                    return std::max({d.x, d.y, d.z}) <= 1 ? std::optional(glm::dot(x, normal)) : std::nullopt;
                },
            .box = box};
}

double area_of(const Surface& surface) {
    double area = 0;
    for (const auto& t : surface.triangles) {
        const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
        area += .5 * glm::length(glm::cross(b - a, c - a));
    }
    return area;
}

TEST(Isosurface, OfADistanceIsASphere) {
    const Surface sphere = isosurface(distance_from(Vec3(0.0)), .7, kBox, 40);
    for (const Vec3& p : sphere.points) ASSERT_NEAR(glm::length(p), .7, 1e-9);
    const double h = 2. / 40, exact = 4 * std::numbers::pi * .49;
    // Flat triangles in a sphere lose a part of the area of about the square of their size over the radius.
    EXPECT_NEAR(area_of(sphere), exact, exact * h * h / .49);
    EXPECT_LT(area_of(sphere), exact);
    double volume = 0;
    for (const auto& t : sphere.triangles) {
        volume += glm::dot(sphere.points[t[0]], glm::cross(sphere.points[t[1]], sphere.points[t[2]])) / 6;
    }
    // The normals point to the smaller values, inward here. The surface is closed: its signed volume is that of the ball.
    EXPECT_NEAR(-volume, 4. / 3 * std::numbers::pi * .343, .01);
}

TEST(Isosurface, ClosedSurfacesHaveEulersNumber) {
    const Surface sphere = isosurface(distance_from(Vec3(.01, .02, .03)), .55, kBox, 17);
    // V − E + F with E = 3F/2.
    EXPECT_EQ(2 * static_cast<int>(sphere.points.size()) - static_cast<int>(sphere.triangles.size()), 4);
}

TEST(Isosurface, EndsBeforeTheDomainDoes) {
    const Surface plane = isosurface(along({0, 0, 1}), .33, kBox, 10);
    EXPECT_NEAR(area_of(plane), 4, 1e-12);
    const Surface outside = isosurface(along({0, 0, 1}), .33, {Vec3(-2.0), Vec3(2.0)}, 20);
    EXPECT_NEAR(area_of(outside), 4, 1e-12);  // the domain's sides are grid planes again
    EXPECT_TRUE(isosurface(along({0, 0, 1}), 1.5, kBox, 10).triangles.empty());
    EXPECT_THROW((void)isosurface(along({0, 0, 1}), 0, kBox, 1), Error);
    EXPECT_THROW((void)isosurface(along({0, 0, 1}), 0, {}, 10), Error);
}

TEST(IsosurfaceDistance, OfParallelPlanes) {
    const FieldView plane = along({0, 0, 1});
    FieldView higher = plane;
    higher.value = [=](const Vec3& x) {
        const auto v = plane.value(x);
        return v ? std::optional(*v - .12) : v;
    };
    const IsosurfaceDistance found = isosurface_distance(higher, plane, .2, 13);
    EXPECT_NEAR(found.distance, .12, 1e-9);
    EXPECT_NEAR(found.spacing, 2. / 13, 1e-12);
    EXPECT_EQ(found.test_triangles, found.reference_triangles);
}

TEST(IsosurfaceDistance, OfTiltedPlanes) {
    // z = −s x against z = 0 over [−1,1]²: from the end (1, −s) straight up it is s, the other way only s/√(1+s²).
    const double slope = .3;
    EXPECT_NEAR(isosurface_distance(along({slope, 0, 1}), along({0, 0, 1}), 0, 16).distance, slope, 1e-9);
    EXPECT_NEAR(isosurface_distance(along({0, 0, 1}), along({slope, 0, 1}), 0, 16).distance, slope, 1e-9);
}

TEST(IsosurfaceDistance, OfSpheres) {
    const double h = 2. / 48, flat = h * h / .5;  // a triangle of up to √3 h lies up to 3h²/(8·.5) below its sphere
    // About the same centre: radii .5 and .5 + .06 (the value .5 of a distance less .06).
    FieldView larger = distance_from(Vec3(0.0));
    larger.value = [](const Vec3& x) { return std::optional(glm::length(x) - .06); };
    EXPECT_NEAR(isosurface_distance(larger, distance_from(Vec3(0.0)), .5, 48).distance, .06, flat);
    // Moved spheres: the distance is that of the move.
    const Vec3 moved(.03, -.05, .02);
    EXPECT_NEAR(isosurface_distance(distance_from(moved), distance_from(Vec3(0.0)), .5, 48).distance, glm::length(moved), flat);
    EXPECT_LT(isosurface_distance(distance_from(moved), distance_from(moved), .5, 48).distance, 1e-15);  // rounding
}

TEST(IsosurfaceDistance, WhereOneOrBothAreMissing) {
    const FieldView plane = along({0, 0, 1}), flat = along({0, 0, .1});
    const IsosurfaceDistance found = isosurface_distance(flat, plane, .5, 10);
    EXPECT_EQ(found.distance, std::numeric_limits<double>::infinity());
    EXPECT_EQ(found.test_triangles, 0u);
    EXPECT_GT(found.reference_triangles, 0u);
    EXPECT_THROW((void)isosurface_distance(plane, plane, 7, 10), Error);
}

TEST(HausdorffDistance, OfTrianglesByHand) {
    const Surface a{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}}};
    // One corner above the inside of the other triangle, one beside an edge, one beyond a corner.
    const Surface b{{Vec3(.2, .2, .7), Vec3(.5, -.3, .4), Vec3(2, 0, 0)}, {{0, 1, 2}}};
    // From b: .7 over the inside, √(.3² + .4²) = .5 to an edge, 1 to a corner. From a: its third corner is √(.04 + .64 + .49)
    // from the first of b, and no nearer to its edges there.
    EXPECT_NEAR(hausdorff_distance(a, b), std::sqrt(.2 * .2 + .8 * .8 + .7 * .7), 1e-12);
    EXPECT_EQ(hausdorff_distance(a, b), hausdorff_distance(b, a));
    EXPECT_EQ(hausdorff_distance({}, {}), 0);
    EXPECT_EQ(hausdorff_distance(a, {}), std::numeric_limits<double>::infinity());
}

}  // namespace isosurface_test
}  // namespace subvol
