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
    float most = 0;
    for (const Vec3& normal : facing_normals()) {
        const auto light = detail::surface_light({}, normal, {0, 0, -1});
        most = std::max(most, light.diffuse);
        EXPECT_EQ(light.specular, 0);
    }
    EXPECT_LE(most, 1);
    EXPECT_GT(most, 0.98F) << "white is white";
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

TEST(Shading, GlossIsThereForThoseWhoAskForIt) {
    const Shading glossy{.specular = 0.25};
    EXPECT_NEAR(detail::surface_light(glossy, {0, 0, -1}, {0, 0, -1}).specular, 0.125, 0.01);
}

}  // namespace shading_test

}  // namespace subvol
