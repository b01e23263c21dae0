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

/// The same wall, which lets light through.
ColoredSurface veil_at(double x, double value, float opacity) {
    ColoredSurface veil = wall_at(x, value);
    veil.opacities.assign(4, opacity);
    return veil;
}

TEST(DrawShells, TranslucentSurfacesKeepOffTheirPartOfTheLight) {
    // The diagonal of the wall, an edge of both of its triangles, goes through the middles of pixels.
    const View view({.eye = {6, 0, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 2}, kSize, kSize);
    const Optics optics = grey_to_white();
    Image opaque(kSize, kSize), veil(kSize, kSize);
    draw_shells(opaque, {}, wall_at(1, 2), {}, view, optics);
    draw_shells(veil, {}, veil_at(1, 2, .25F), {}, view, optics);
    for (std::size_t i = 0; i < veil.rgba.size(); ++i) ASSERT_NEAR(veil.rgba[i], .25F * opaque.rgba[i], 1e-6) << i;
}

TEST(DrawShells, TranslucentSurfacesLieOneOverTheOtherInAnyOrderAndBeforeTheVolume) {
    const Surface body = colored_box().surface;
    const View view = view_of({6, .5, .5});
    const Optics optics = grey_to_white();
    const int middle = kSize / 2;
    const auto color_of = [&](double x, double value) {
        Image image(kSize, kSize);
        draw_shells(image, {}, wall_at(x, value), {}, view, optics);
        return image.pixel(middle, middle)[1];
    };
    for (const bool far_first : {false, true}) {
        ColoredSurface both = veil_at(far_first ? 1.5 : 2, far_first ? 0 : 3, far_first ? .5F : .25F);
        const ColoredSurface second = veil_at(far_first ? 2 : 1.5, far_first ? 3 : 0, far_first ? .25F : .5F);
        for (const auto& [a, b, c] : second.surface.triangles) both.surface.triangles.push_back({a + 4, b + 4, c + 4});
        both.surface.points.insert(both.surface.points.end(), second.surface.points.begin(), second.surface.points.end());
        both.values.insert(both.values.end(), second.values.begin(), second.values.end());
        both.opacities.insert(both.opacities.end(), second.opacities.begin(), second.opacities.end());
        Image image = filled(0, 1);
        image.pixel(middle, middle)[1] = .8F;
        draw_shells(image, {}, both, body, view, optics);
        const float expected = .25F * color_of(2, 3) + .75F * (.5F * color_of(1.5, 0) + .5F * .8F);
        EXPECT_NEAR(image.pixel(middle, middle)[1], expected, 1e-5);
        EXPECT_NEAR(image.pixel(middle, middle)[3], 1, 1e-6);
    }
    Image behind = filled(.5F, 1);
    const float before = behind.pixel(middle, middle)[0];
    draw_shells(behind, {}, veil_at(-1, 1, .5F), body, view, optics);
    EXPECT_EQ(behind.pixel(middle, middle)[0], before) << "what is behind an opaque body is not seen";
}

TEST(DrawShells, RefuseWhatDoesNotFit) {
    Image image(kSize, kSize), small(8, 8);
    ColoredSurface wall = wall_at(0, 1);
    const auto draw = [&](Image& into) { draw_shells(into, {}, wall, {}, view_of({5, 0, 0}), grey_to_white()); };
    test::expect_error(ErrorCode::InvalidInput, "not of one size", [&] { draw(small); });
    wall.opacities = {1, 1, 1};
    test::expect_error(ErrorCode::InvalidInput, "one opacity", [&] { draw(image); });
    wall.opacities.clear();
    wall.values.pop_back();
    test::expect_error(ErrorCode::InvalidInput, "3 values for 4 points", [&] { draw(image); });
}

}  // namespace draw_shells_test
}  // namespace subvol
