// SPDX-License-Identifier: Apache-2.0
// The light that all renderers share.
#include "subvol/shading.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace subvol {
namespace shading_test {

/// Normals that face the eye, evenly over the half sphere.
std::vector<Vec3> facing_normals() {
    std::vector<Vec3> normals;
    for (int i = 0; i < 40; ++i) {
        for (int j = 0; j < 120; ++j) {
            const double z = (i + 0.5) / 40, turn = 2 * std::numbers::pi * j / 120, r = std::sqrt(1 - z * z);
            normals.emplace_back(r * std::cos(turn), r * std::sin(turn), -z);
        }
    }
    return normals;
}

TEST(Shading, NoSurfaceGetsMoreLightThanThereIsAndNoneGleams) {
    for (const Shading& shading : {Shading{}, plain_shading()}) {
        float most = 0;
        for (const Vec3& normal : facing_normals()) {
            const auto light = detail::surface_light(shading, normal, {0, 0, -1});
            most = std::max(most, light.diffuse);
            EXPECT_EQ(light.specular, 0);
        }
        EXPECT_LE(most, 1);
        EXPECT_GT(most, 0.98F) << "white is white";
    }
}

TEST(Shading, WhiteStaysWhiteInFourViews) {
    const double to_side = 1 / std::sqrt(2), down = 1 / std::sqrt(3);
    EXPECT_GT(detail::surface_light({}, {0, 0, -1}, {0, 0, -1}).diffuse, 0.89F) << "front, right and top: faced";
    EXPECT_GT(detail::surface_light({}, {0, std::sqrt(2.0 / 3), -down}, {0, 0, -1}).diffuse, 0.85F)
        << "the top of a box from its corner";
    for (const double side : {-to_side, to_side}) {
        const float light = detail::surface_light({}, {side, -std::sqrt(1.0 / 6), -down}, {0, 0, -1}).diffuse;
        EXPECT_GT(light, 0.5F) << "its sides are not black";
        EXPECT_LT(light, 0.8F) << "and are told from its top";
    }
}

TEST(Shading, TheLightFromTheEyeAndFromTheKeyAddUpToTheDiffuseLight) {
    for (const double head : {0.0, 0.25, 1.0}) {
        const Shading shading{.ambient = 0.1, .diffuse = 0.9, .head = head, .key = {1, 0, 0}};
        EXPECT_NEAR(detail::surface_light(shading, {0, 0, -1}, {0, 0, -1}).diffuse, 0.1 + 0.9 * head, 1e-6);
        EXPECT_NEAR(detail::surface_light(shading, {1, 0, 0}, {0, 0, -1}).diffuse, 0.1 + 0.9 * (1 - head), 1e-6);
        EXPECT_NEAR(detail::surface_light(shading, {0, 0, 1}, {0, 0, -1}).diffuse, 0.1, 1e-6);
    }
}

TEST(Shading, OnlyColoursThatCarryNoValueGetTheLightThatShowsTheShapeBest) {
    const TransferFunction grey{.color = {{0, {.5, .6, .7}}, {1, {.5, .6, .7}}}, .opacity = {{0, 1}}};
    TransferFunction colored = grey;
    colored.color[1].rgb.z = 0.71;
    const Vec3 lit = glm::normalize(Vec3(0, 1, -1)), shaded = glm::normalize(Vec3(1, -1, -1)), to_eye(0, 0, -1);
    const auto contrast = [&](const TransferFunction& map) {
        const Shading shading = shading_for(map);
        return detail::surface_light(shading, lit, to_eye).diffuse / detail::surface_light(shading, shaded, to_eye).diffuse;
    };
    EXPECT_GT(contrast(grey), 3);
    EXPECT_EQ(contrast(colored),
              detail::surface_light({}, lit, to_eye).diffuse / detail::surface_light({}, shaded, to_eye).diffuse);
}

TEST(Shading, GlossIsThereForThoseWhoAskForIt) {
    const Shading glossy{.specular = 0.25};
    EXPECT_NEAR(detail::surface_light(glossy, {0, 0, -1}, {0, 0, -1}).specular, 0.125, 0.01);
}

}  // namespace shading_test

}  // namespace subvol
