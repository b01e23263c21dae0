// SPDX-License-Identifier: Apache-2.0
// Light on splats.
#include <gtest/gtest.h>

#include "splat_scenes.h"
#include "subvol/splat.h"

namespace subvol::test {
namespace splat_light_test {

constexpr int kSize_px = 48;

View view_along_y(double height) {
    return {{.eye = {.5, -5, .5}, .target = {.5, 0, .5}, .up = {0, 0, 1}, .ortho_height = height}, kSize_px, kSize_px};
}

/// One colour and opacity; the larger the range, the larger the gradient of a surface.
Optics plain_optics(double range) {
    return Optics({.color = {{0, {.8, .4, .2}}, {range, {.8, .4, .2}}}, .opacity = {{0, .3}, {range, .3}}}, .5);
}

TEST(SplatLight, ASlabWithAConstantGradientHasItsClosedForm) {
    const Vec3 normal = glm::normalize(Vec3(.4, -.7, .5));
    HexMesh slab = jittered_box(3, .2, 9);
    add_field(slab, "f", [&](const Vec3& p) { return glm::dot(normal, p); });
    const RbfVolume volume = sample_rbf_points(slab).volume;
    const double alpha = 1 - std::pow(.7, 2);
    const Vec3 to_eye(0, -1, 0);  // in the world: right is x, up is z, forward is y
    for (const Vec3& key : {Vec3(-.5, .7, -.5), Vec3(2, 1, -.3), Vec3(0, 0, -1)}) {
        const Shading shading{.ambient = .2, .diffuse = .6, .specular = .3, .shininess = 5, .key = key};
        const Vec3 to_key = glm::normalize(Vec3(key.x, key.z, key.y)), halfway = glm::normalize(to_key + to_eye);
        const auto both = [&](const Vec3& a, const Vec3& b, double power) {
            return .5 * (std::pow(std::abs(glm::dot(normal, a)), power) + std::pow(std::abs(glm::dot(normal, b)), power));
        };
        const double lit = .2 + .6 * both(to_eye, to_key, 1), gloss = .3 * both(to_eye, halfway, 5);
        // With a thousandth of the range the field is a surface up to 1e-7.
        const auto image =
            render_splats(volume, view_along_y(1.2), plain_optics(1e-3), {.method = SplatMethod::Cpu, .shading = shading})
                .image;
        for (int y = 8; y < 40; ++y) {
            for (int x = 8; x < 40; ++x) {
                const auto pixel = image.pixel(x, y);
                // Gradients are float sums over some ten kernels; the shininess is five.
                EXPECT_NEAR(pixel[0], alpha * (.8 * lit + gloss), 2e-5);
                EXPECT_NEAR(pixel[2], alpha * (.2 * lit + gloss), 2e-5);
                EXPECT_NEAR(pixel[3], alpha, 2e-6);
            }
        }
    }
}

TEST(SplatLight, TheSideTowardsTheKeyLightIsBrighter) {
    HexMesh ball = nested_ball(4);
    add_field(ball, "f", [](const Vec3& p) { return 1 - glm::dot(p, p); });
    const View view({.eye = {0, -5, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 2}, kSize_px, kSize_px);
    const auto volume = sample_rbf_points(ball).volume;
    const auto brightness = [&](const Vec3& key, int x, int y) {
        const Shading shading{.key = key};
        const auto image = render_splats(volume, view, plain_optics(1), {.method = SplatMethod::Cpu, .shading = shading}).image;
        return image.pixel(x, y)[1] / image.pixel(x, y)[3];
    };
    constexpr int kNear = 12, kFar = kSize_px - 1 - kNear, kMiddle = kSize_px / 2;
    const Vec3 from_left(-1, 0, -.3), from_above(0, 1, -.3);
    // Surfaces are lit from either side: the back of the ball leans to the light but is covered by the front, which leans away.
    EXPECT_GT(brightness(from_left, kNear, kMiddle), brightness(from_left, kMiddle, kNear) + .02F);
    EXPECT_GT(brightness(from_above, kMiddle, kNear), brightness(from_above, kNear, kMiddle) + .02F);
    EXPECT_GT(brightness(from_left, kNear, kMiddle), brightness(from_left, kFar, kMiddle));
    EXPECT_GT(brightness(from_above, kMiddle, kNear), brightness(from_above, kMiddle, kFar));
}

TEST(SplatLight, AConstantFieldHasNoSurfaces) {
    HexMesh box = jittered_box(3, .2, 9);
    add_field(box, "f", [](const Vec3&) { return .5; });
    const RbfVolume volume = sample_rbf_points(box).volume;
    const auto draw = [&](std::optional<Shading> shading) {
        return render_splats(volume, view_along_y(1.2), smooth_optics(), {.method = SplatMethod::Cpu, .shading = shading})
            .image;
    };
    EXPECT_LT(largest_difference(draw(Shading{}), draw({})), 2e-6);  // other loops: the rounding of products of 200 floats
}

}  // namespace splat_light_test
}  // namespace subvol::test
