// SPDX-License-Identifier: Apache-2.0
#include "gl_boundary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "gl_context.h"
#include "lib/random_vector.h"
#include "lib/test_meshes.h"
#include "subvol/error.h"

namespace subvol {
namespace gl_boundary_test {

using detail::GlBoundary;
using detail::GlStages;
using detail::PixelIntervals;

class GlBoundaries : public testing::Test {
protected:
    void SetUp() override {
        if (!find_gl_device()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
        context_ = std::make_unique<detail::GlContext>();
    }

private:
    std::unique_ptr<detail::GlContext> context_;
};

constexpr double kNear = .01, kMiddle = 4;

PixelIntervals on_gpu(GlBoundary& boundary, const Surface& surface, const View& view) {
    GlStages stages;
    do boundary.find(surface, view, kNear, kMiddle, stages);
    while (!boundary.found_all());
    return boundary.read(static_cast<std::size_t>(view.width()) * static_cast<std::size_t>(view.height()));
}

void expect_like_cpu(const Surface& surface, const View& view) {
    GlBoundary boundary(true);
    const auto expected = detail::boundary_intervals(surface, view, kNear, kMiddle), found = on_gpu(boundary, surface, view);
    EXPECT_EQ(found.hits, expected.hits);
    EXPECT_EQ(found.offsets, expected.offsets);
    ASSERT_EQ(found.depths.size(), expected.depths.size());
    EXPECT_GT(found.depths.size(), 100u);
    // The same operations in double precision; the final rounding to float may differ.
    for (std::size_t i = 0; i < found.depths.size(); ++i) EXPECT_NEAR(found.depths[i], expected.depths[i], 1e-6) << i;
}

Surface surface_of(HexMesh mesh, double size, const Vec3& at) {
    Surface surface = boundary_surface(mesh);
    for (auto& p : surface.points) p = size * p + at;
    return surface;
}

void append(Surface& to, const Surface& more) {
    const auto first = static_cast<Index>(to.points.size());
    to.points.insert(to.points.end(), more.points.begin(), more.points.end());
    for (const auto& t : more.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

View view_of(bool perspective, int width = 75, int height = 61) {
    return View({.eye = {.3, -4, .5}, .target = {.1, 0, 0}, .up = {0, 0, 1}, .ortho_height = perspective ? 0 : 3.1}, width,
                height);
}

TEST_F(GlBoundaries, NestedTouchingAndCrumpledShellsAreAsOnTheCpu) {
    for (const bool perspective : {true, false}) {
        Surface surface = surface_of(test::make_nested_cubes(2), 1, {0, 0, 0});
        append(surface, surface_of(test::make_nested_cubes(1), .4, {.1, .1, .2}));
        append(surface, surface_of(test::make_box(2, 1, 3), .4, {1, -.2, -1}));
        append(surface, surface_of(test::make_box(1, 1, 1), .4, {1, .2, -1}));  // one of its faces touches the box before
        expect_like_cpu(surface, view_of(perspective));
        std::mt19937 random(3);
        std::uniform_real_distribution<double> shift(-.2, .2);
        for (auto& p : surface.points) p += test::random_vector(shift, random);
        expect_like_cpu(surface, view_of(perspective));
    }
}

TEST_F(GlBoundaries, EdgesThroughPixelCentresAreOwnedOnce) {
    // A unit is a whole number of pixels: edges, diagonals and corners lie on pixel centres.
    Surface surface = surface_of(test::make_box(5, 3, 5), 1, {0, 0, 0});
    const View view({.eye = {2.5, -4, 2.5}, .target = {2.5, 0, 2.5}, .up = {0, 0, 1}, .ortho_height = 7}, 49, 49);
    expect_like_cpu(surface, view);
}

TEST_F(GlBoundaries, WhatHasToBeClippedComesFromTheCpu) {
    const Surface surface = surface_of(test::make_nested_cubes(2), 1, {0, 0, 0});
    const View inside({.eye = {.1, 0, 0}, .target = {1, .2, .1}, .up = {0, 0, 1}, .fovy_deg = 70}, 40, 40);
    EXPECT_TRUE(detail::needs_clipping(surface.points, inside, kNear));
    EXPECT_FALSE(detail::needs_clipping(surface.points, view_of(true), kNear));
    expect_like_cpu(surface, inside);
}

TEST_F(GlBoundaries, RaysThatMeetTooManyShellsForAThreadComeFromTheCpu) {
    Surface surface;
    for (int i = 300; i > 0; --i) append(surface, surface_of(test::make_box(1, 1, 1), .004, {0, .01 * i, 0}));
    for (auto& p : surface.points) p = Vec3(200 * p.x, p.y, 200 * p.z);
    expect_like_cpu(surface, view_of(false, 16, 16));
}

TEST_F(GlBoundaries, TrianglesWithTooManyRowsForADispatchComeFromTheCpu) {
    // Needles across the picture: their boxes cover all of it, they themselves hardly a pixel.
    Surface surface;
    for (int i = 0; i < 200; ++i) {
        append(surface, surface_of(test::make_box(1, 1, 1), 1, {0, 0, 0}));
        const double shift = .02 * i - 2;
        for (std::size_t k = surface.points.size() - 8; k < surface.points.size(); ++k) {
            Vec3& p = surface.points[k];
            p = Vec3(3 * p.x - 1.5 + shift, .01 * p.y, 3 * p.x - 1.5 - shift + .02 * p.z);
        }
    }
    const View view = view_of(false, 1024, 1024);
    expect_like_cpu(surface, view);
    GlBoundary boundary(true);
    GlStages stages;
    boundary.find(surface, view, kNear, kMiddle, stages);
    EXPECT_EQ(boundary.hits(), detail::boundary_intervals(surface, view, kNear, kMiddle).hits)
        << "known without waiting: the CPU has found them";
}

TEST_F(GlBoundaries, PointsBetweenTwoStepsOfTheRasterAreRoundedAsOnTheCpu) {
    // Every corner lies in the middle between two of the 4096 steps of a pixel, where the last bit of a quotient would decide.
    Surface surface = surface_of(test::make_nested_cubes(2), 1, {0, 0, 0});
    const double step = 7.0 / 49 / 4096;
    for (auto& p : surface.points)
        p = Vec3((std::round(p.x * 300) * 97 + .5) * step, p.y, (std::round(p.z * 300) * 89 + .5) * step);
    const View view({.eye = {0, -4, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 7}, 49, 49);
    expect_like_cpu(surface, view);
}

TEST_F(GlBoundaries, PartsThatAreTurnedInsideOutAreAsOnTheCpu) {
    for (const double thickness : {1e-6, 1e-3, 1.0}) {
        Surface surface = surface_of(test::make_nested_cubes(2), 1, {0, 0, 0});
        for (auto& p : surface.points) p.y *= -thickness;
        expect_like_cpu(surface, view_of(false, 33, 33));
    }
}

TEST(IntervalsForGl, AreLimited) {
    PixelIntervals intervals{.offsets = {0, 3, 3 + detail::kMostGlIntervals}, .depths = {}, .triangles = {}};
    EXPECT_NO_THROW(detail::check_for_gl(intervals));
    ++intervals.offsets.back();
    EXPECT_THROW(detail::check_for_gl(intervals), Error);
}

TEST_F(GlBoundaries, ViewsThatNeedMoreRoomGetIt) {
    const Surface surface = surface_of(test::make_nested_cubes(2), 1, {0, 0, 0});
    GlBoundary boundary(true);
    for (const int size : {20, 70, 33}) {
        const View view = view_of(true, size, size);
        EXPECT_EQ(on_gpu(boundary, surface, view).offsets, detail::boundary_intervals(surface, view, kNear, kMiddle).offsets);
    }
}

}  // namespace gl_boundary_test
}  // namespace subvol
