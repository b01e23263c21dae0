// SPDX-License-Identifier: Apache-2.0
#include "subvol/draw_shells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/boundary_shading.h"
#include "subvol/picture_look.h"

namespace subvol {
namespace draw_shells_test {

constexpr int kSize = 48;

Optics grey_to_white() {
    return {find_transfer_function("viridis", {0, 3}), 1.0};
}

View view_of(const Vec3& eye) {
    return {{.eye = eye, .target = Vec3(.5), .up = Vec3(0, 0, 1), .fovy_deg = 30}, kSize, kSize};
}

/// A box with the value x + y at its points.
ColoredSurface colored_box() {
    ColoredSurface box{boundary_surface(test::make_box(2, 2, 2)), {}};
    for (Vec3& p : box.surface.points) {
        p *= .5;
        box.values.push_back(2 * p.x + p.y);
    }
    return box;
}

/// A square of side 4 across the x axis.
ColoredSurface wall_at(double x, double value) {
    ColoredSurface wall;
    wall.surface.points = {{x, -2, -2}, {x, 2, -2}, {x, 2, 2}, {x, -2, 2}};
    wall.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
    wall.values.assign(4, value);
    return wall;
}

Image filled(float red, float alpha) {
    Image image(kSize, kSize);
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            image.pixel(x, y)[0] = red;
            image.pixel(x, y)[3] = alpha;
        }
    }
    return image;
}

TEST(DrawShells, ABoxOfShellsLooksAsTheBoundaryOfASolidDoes) {
    const ColoredSurface box = colored_box();
    const Optics optics = grey_to_white();
    for (const Vec3& eye : {Vec3(4, -3, 2.5), Vec3(-3, 2, 4)}) {
        const View view = view_of(eye);
        Image shells(kSize, kSize), solid = filled(0, 1);
        draw_shells(shells, {}, box, {}, view, optics);
        color_boundary(solid, box.surface, box.values, view, optics, Shading{});
        int covered = 0, differing = 0;
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                const auto a = shells.pixel(x, y), b = solid.pixel(x, y);
                if (a[3] == 0) continue;
                ++covered;
                EXPECT_EQ(a[3], 1);
                for (std::size_t c = 0; c < 3; ++c) differing += std::abs(a[c] - b[c]) > 1e-4F;
            }
        }
        EXPECT_GT(covered, 300);
        // At the edges of the box and its outline, rays that pass within 1/4096 of a pixel may take the other face.
        EXPECT_LE(differing, 6);
    }
}

TEST(DrawShells, WhatIsBehindTheEyeHidesNothing) {
    for (const double ortho_height : {0.0, 2.0}) {
        const auto covered = [&](double x) {
            const View view({.eye = Vec3(2, 0, 0), .target = Vec3(0), .up = Vec3(0, 0, 1), .ortho_height = ortho_height}, kSize,
                            kSize);
            Image image(kSize, kSize);
            std::vector<float> depth(static_cast<std::size_t>(kSize * kSize), HUGE_VALF);
            draw_shells(image, depth, wall_at(x, 1), {}, view, grey_to_white());
            float most = 0;
            for (std::size_t i = 3; i < image.rgba.size(); i += 4) most = std::max(most, image.rgba[i]);
            EXPECT_EQ(std::ranges::min(depth) == HUGE_VALF, most == 0);
            return most;
        };
        EXPECT_EQ(covered(1.9), 1) << ortho_height;
        EXPECT_EQ(covered(2.1), 0) << ortho_height;
        EXPECT_EQ(covered(9), 0) << ortho_height;
    }
}

TEST(DrawShells, WhatIsInFrontHidesAndWhatIsBehindIsHiddenAsFarAsTheVolumeIsOpaque) {
    const Surface body = colored_box().surface;
    const View view = view_of({6, .5, .5});
    const Optics optics = grey_to_white();
    const int middle = kSize / 2;
    Image alone(kSize, kSize);
    draw_shells(alone, {}, wall_at(-1, 1), {}, view, optics);
    const float wall_red = alone.pixel(middle, middle)[0];
    for (const float alpha : {1.0F, .25F}) {
        Image before = filled(.5F * alpha, alpha), behind = before;
        draw_shells(before, {}, wall_at(2, 1), body, view, optics);
        EXPECT_EQ(before.pixel(middle, middle)[3], 1);
        EXPECT_NEAR(before.pixel(middle, middle)[0], alone.pixel(middle, middle)[0], 1e-5);
        draw_shells(behind, {}, wall_at(-1, 1), body, view, optics);
        EXPECT_NEAR(behind.pixel(middle, middle)[0], .5F * alpha + (1 - alpha) * wall_red, 1e-5);
        EXPECT_NEAR(behind.pixel(middle, middle)[3], 1, 1e-6);
    }
}

TEST(DrawShells, BothSidesAreLitAlike) {
    const Optics optics = grey_to_white();
    ColoredSurface turned = wall_at(0, 2);
    for (auto& [a, b, c] : turned.surface.triangles) std::swap(b, c);
    Image one(kSize, kSize), other(kSize, kSize);
    draw_shells(one, {}, wall_at(0, 2), {}, view_of({5, 2, 1}), optics);
    draw_shells(other, {}, turned, {}, view_of({5, 2, 1}), optics);
    for (std::size_t i = 0; i < one.rgba.size(); ++i) ASSERT_NEAR(one.rgba[i], other.rgba[i], 1e-6);
}

TEST(DrawShells, GiveTheirDepthAndAreCut) {
    const View view = view_of({6, .5, .5});
    Image image(kSize, kSize);
    std::vector<float> depth(static_cast<std::size_t>(kSize * kSize), 1e9F);
    draw_shells(image, depth, wall_at(1, 1), {}, view, grey_to_white());
    EXPECT_NEAR(depth[static_cast<std::size_t>(kSize * (kSize / 2) + kSize / 2)], 5, 1e-5);
    Image cut(kSize, kSize);
    draw_shells(cut, {}, wall_at(1, 1), {}, view, grey_to_white(),
                {.samples = 2, .clip = {.planes = {{Vec3(.9, 0, 0), Vec3(1, 0, 0)}}}});
    EXPECT_EQ(cut.rgba, Image(kSize, kSize).rgba);
}

TEST(DrawShells, AreNotSeenBehindTheEndOfARay) {
    View view = view_of(Vec3(4, .5, .5));  // 3.5 before a wall
    std::vector<float> ends(kSize * kSize, 3.6F);
    for (std::size_t i = 0; i < ends.size() / 2; ++i) ends[i] = 3.4F;
    view.end_rays(ends);
    Image image(kSize, kSize);
    draw_shells(image, {}, wall_at(.5, 1), {}, view, grey_to_white(), {.samples = 2});
    EXPECT_EQ(image.pixel(kSize / 2, kSize / 2 - 1)[3], 0);
    EXPECT_EQ(image.pixel(kSize / 2, kSize / 2)[3], 1);
}

TEST(DrawShells, RefuseWhatDoesNotFit) {
    Image image(kSize, kSize), small(8, 8);
    ColoredSurface wall = wall_at(0, 1);
    const auto draw = [&](Image& into) { draw_shells(into, {}, wall, {}, view_of({5, 0, 0}), grey_to_white()); };
    test::expect_error(ErrorCode::InvalidInput, "not of one size", [&] { draw(small); });
    wall.values.pop_back();
    test::expect_error(ErrorCode::InvalidInput, "3 values for 4 points", [&] { draw(image); });
}

}  // namespace draw_shells_test
}  // namespace subvol
