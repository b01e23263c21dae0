// SPDX-License-Identifier: Apache-2.0
// One kernel for each control vertex against the limit volume, at extraordinary edges and vertices.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "splat_scenes.h"
#include "subvol/limit.h"
#include "subvol/model.h"
#include "subvol/refine.h"
#include "subvol/render_tets.h"
#include "subvol/splat.h"

namespace subvol::test {
namespace splat_ball_test {

constexpr int kSize_px = 96;

View view() {
    return {{.eye = {2.6, -4.2, 2.0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 26}, kSize_px, kSize_px};
}

Optics optics_of(bool sharp) {
    TransferFunction f{.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}},
                       .opacity = {{-1, .30}, {-.3, .05}, {0, 0}, {.3, .05}, {1, .40}}};
    if (sharp) f.opacity = {{-1, 0}, {.27, 0}, {.30, .9}, {.33, 0}, {1, 0}};
    return {f, 0.1};
}

/// The pixels that see the volume and whose eight neighbours do too: silhouettes differ by less than a pixel.
std::vector<bool> interior(const HexMesh& mesh) {
    const Optics solid({.color = {{0, {1, 1, 1}}}, .opacity = {{0, .5}}}, .1);
    const Image image =
        render_splats(sample_rbf_points(mesh).volume, view(), solid, {.method = SplatMethod::Cpu, .sheets = 3}).image;
    std::vector<bool> inside(std::size_t{kSize_px} * kSize_px, false);
    for (int y = 1; y + 1 < kSize_px; ++y) {
        for (int x = 1; x + 1 < kSize_px; ++x) {
            bool all = true;
            for (int k = 0; k < 9; ++k) all = all && image.pixel(x + k % 3 - 1, y + k / 3 - 1)[3] > 0;
            inside[static_cast<std::size_t>(y * kSize_px + x)] = all;
        }
    }
    return inside;
}

double rmse_where(const std::vector<bool>& pixels, const Image& a, const Image& b) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) {
        if (!pixels[i / 4] || i % 4 == 3) continue;
        sum += std::pow(static_cast<double>(a.rgba[i]) - static_cast<double>(b.rgba[i]), 2);
        ++count;
    }
    return std::sqrt(sum / count);
}

TEST(SplatBall, OneKernelAControlVertexIsNearTheLimit) {
    const HexMesh mesh = make_model("ball", 10);
    const HexMesh fine = on_limit(refine(mesh, {.levels = 2}), Scheme::Mcq);
    const auto inside = interior(mesh);
    EXPECT_GT(std::count(inside.begin(), inside.end(), true), kSize_px * kSize_px / 2);
    for (const bool sharp : {false, true}) {
        const Image limit = render_tets(fine, {}, view(), optics_of(sharp)).image;
        const auto splat = [&](Correction correction) {
            const auto volume = sample_rbf_points(mesh, {.correction = correction}).volume;
            const SplatOptions options{.method = SplatMethod::Cpu, .sheets = 400};
            return rmse_where(inside, render_splats(volume, view(), optics_of(sharp), options).image, limit);
        };
        const double none = splat(Correction::None), second = splat(Correction::Second), full = splat(Correction::Full);
        // The error of the trilinear cells at level 2 is some .0004 (smooth) and .002: a third of the difference from level 1.
        // A sharp peak has slopes of 30 where the smooth function has a slope of 1.
        EXPECT_LT(second, none / (sharp ? 3 : 7));
        EXPECT_LT(full, none / (sharp ? 4 : 7));
        EXPECT_TRUE(sharp || second < .001) << second;
    }
}

}  // namespace splat_ball_test
}  // namespace subvol::test
