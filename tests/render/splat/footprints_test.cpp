// SPDX-License-Identifier: Apache-2.0
// Kernels that are coloured first and composited one by one.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numbers>
#include <variant>

#include "lib/expect_error.h"
#include "render/constant_optics.h"
#include "splat_scenes.h"
#include "subvol/splat.h"

namespace subvol::test {
namespace footprints_test {

const SplatOptions kFootprints{.method = SplatMethod::Footprints};

/// Kernels of the splatter, whose sample interval is 1.
RbfVolume kernels_at(const std::vector<Vec3>& centers, const std::vector<float>& values, const Kernel& kernel) {
    RbfVolume volume;
    volume.kernel = kernel;
    volume.centers = centers;
    const auto square = static_cast<float>(support_radius(kernel) * support_radius(kernel));
    volume.frames.assign(centers.size(), {square, 0, 0, square, 0, square});
    volume.channels = {{.name = "f",
                        .values = values,
                        .gradients = std::vector<std::array<float, 3>>(centers.size()),
                        .moments = std::vector<float>(centers.size())}};
    HexMesh box = test::box(1);
    for (Vec3& p : box.points) p = 3.5 * (2.0 * p - 1.0);
    volume.boundary = boundary_surface(box);
    return volume;
}

double optical_depth(float alpha) {
    return -std::log1p(-static_cast<double>(alpha));
}

TEST(Footprints, HaveTheIntegralsOfTheirKernel) {
    constexpr double kSigma = 0.43;
    const RbfVolume volume = kernels_at({{.1, .2, -.1}}, {.5F}, GaussianKernel{.sigma = kSigma, .amplitude = 2, .radius = 3});
    const View view({.eye = {0, -10, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 7}, 70, 70);
    const Image image = render_splats(volume, view, constant_optics(), kFootprints).image;
    const double extinction = std::log(2.0),
                 peak = 1 / (2 * std::numbers::pi * kSigma * kSigma);  // of a weight whose integral is 1
    for (int y = 0; y < 70; ++y) {
        for (int x = 0; x < 70; ++x) {
            const Vec2 p = view.slopes(x + .5, y + .5) - Vec2(.1, -.1);
            const double expected = extinction * peak * std::exp(-glm::dot(p, p) / (2 * kSigma * kSigma));
            // The table has 1,024 cells over the square of the radius: its chords are off by h²/8 of the second derivative.
            EXPECT_NEAR(optical_depth(image.pixel(x, y)[3]), expected, 4e-4 * extinction * peak) << x << ' ' << y;
        }
    }
}

TEST(Footprints, OfACompactKernelHaveItsClosedForm) {
    // ∫ (1 − x²/R²)³ dx = 32 R/35 through the middle; over space 64 π R³/315.
    const RbfVolume volume = kernels_at({{0, 0, 0}}, {.5F}, CompactKernel{.radius = 1.43});
    const View view({.eye = {4, -3, 2}, .target = {0, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 30}, 33, 33);
    const Image image = render_splats(volume, view, constant_optics(), kFootprints).image;
    const double expected = std::log(2.0) * (32.0 / 35) / (64 * std::numbers::pi / 315 * 1.43 * 1.43);
    EXPECT_NEAR(optical_depth(image.pixel(16, 16)[3]), expected, 1e-3 * expected);
}

TEST(Footprints, AddUpToTheLengthOfTheVolume) {
    // Nothing cuts the kernels on the boundary in half: there are 17 on the length of 16.
    HexMesh mesh = jittered_box(16, 0, 1);
    add_field(mesh, "f", [](const Vec3&) { return .5; });
    const RbfVolume volume = sample_rbf_points(mesh).volume;
    constexpr double kRadius = 1.43;
    ASSERT_EQ(std::get<CompactKernel>(volume.kernel).radius, kRadius);
    // Along an axis of the lattice footprints lie on one another, and their sum goes up and down.
    const auto sum_at = [](const Vec2& place) {
        double sum = 0;
        for (int i = 0; i <= 16; ++i) {
            for (int j = 0; j <= 16; ++j) {
                const Vec2 offset = 16.0 * place - Vec2(i, j);
                const double rest = 1 - glm::dot(offset, offset) / (kRadius * kRadius);
                if (rest > 0) sum += (32.0 / 35) / (64 * std::numbers::pi / 315 * kRadius * kRadius) * std::pow(rest, 3.5);
            }
        }
        return sum;
    };
    const View along({.eye = {.5, -5, .5}, .target = {.5, .5, .5}, .up = {0, 0, 1}, .ortho_height = .2}, 16, 16);
    const Image straight = render_splats(volume, along, constant_optics(), kFootprints).image;
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) {
            const double expected = std::log(2.0) * 17 / 16 * sum_at(Vec2(.5, .5) + along.slopes(x + .5, y + .5));
            EXPECT_NEAR(optical_depth(straight.pixel(x, y)[3]), expected, 1e-3) << x << ' ' << y;
        }
    }
    const View across({.eye = {4, -3, 2}, .target = {.5, .5, .5}, .up = {0, 0, 1}, .ortho_height = .2}, 16, 16);
    const Image footprints = render_splats(volume, across, constant_optics(), kFootprints).image;
    const Image splats = render_splats(volume, across, constant_optics(), {.method = SplatMethod::Cpu}).image;
    for (std::size_t i = 3; i < footprints.rgba.size(); i += 4) {
        EXPECT_NEAR(optical_depth(footprints.rgba[i]) / optical_depth(splats.rgba[i]), 17.0 / 16, .02);
    }
}

TEST(Footprints, AreCompositedByDepth) {
    const RbfVolume volume = kernels_at({{0, -1, 0}, {0, 1, 0}}, {0, 1}, CompactKernel{});
    const Optics optics({.color = {{0, {1, 0, 0}}, {1, {0, 0, 1}}}, .opacity = {{0, .9999}, {1, .9999}}}, .05);
    for (const double side : {-1.0, 1.0}) {
        const View view({.eye = {0, side * 10, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 3}, 9, 9);
        const SplatResult drawn = render_splats(volume, view, optics, kFootprints);
        const auto middle = drawn.image.pixel(4, 4);
        EXPECT_GT(middle[side < 0 ? 0 : 2], .999F);
        EXPECT_LT(middle[side < 0 ? 2 : 0], .001F);
        EXPECT_NEAR(drawn.depth[4 * 9 + 4], 9, 1e-3);
    }
}

TEST(Footprints, DoNotSeeAPeakBetweenTwoValues) {
    // What is classified first has the colours of the kernels alone.
    HexMesh mesh = jittered_box(8, 0, 1);
    add_field(mesh, "f", [](const Vec3& p) { return p.x < .44 ? 0.0 : 1.0; });
    const RbfVolume volume = sample_rbf_points(mesh).volume;
    const Optics optics({.color = {{0, {1, 1, 1}}}, .opacity = {{0, 0}, {.4, 0}, {.5, .9}, {.6, 0}, {1, 0}}}, .05);
    const View view({.eye = {.5, -5, .5}, .target = {.5, .5, .5}, .up = {0, 0, 1}, .ortho_height = 1}, 64, 64);
    const Image before = render_splats(volume, view, optics, kFootprints).image;
    const Image after = render_splats(volume, view, optics, {.method = SplatMethod::Cpu}).image;
    const auto most = [](const Image& image) { return *std::ranges::max_element(image.rgba); };
    EXPECT_EQ(most(before), 0);
    EXPECT_GT(most(after), .5F);
}

TEST(Footprints, HaveTheSameBitsWithAnyNumberOfThreads) {
    const RbfVolume volume = sample_rbf_points(with_waves(nested_ball(4))).volume;
    const View view(perspective_camera(), 120, 90);
    const auto draw = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return render_splats(volume, view, smooth_optics(),
                             {.method = SplatMethod::Footprints, .samples = 2, .shading = Shading{}});
    };
    const SplatResult one = draw(1), many = draw(4);
    EXPECT_EQ(one.image.rgba, many.image.rgba);
    EXPECT_EQ(one.depth, many.depth);
    EXPECT_GT(*std::ranges::max_element(one.image.rgba), .5F);
}

TEST(Footprints, RefuseWhatTheyDoNotKnow) {
    const RbfVolume volume = sample_rbf_points(with_waves(nested_ball(2))).volume;
    expect_error(ErrorCode::InvalidInput, "shadows",
                 [&] { Splatter(volume, {.method = SplatMethod::Footprints, .shadows = true}); });
    const Clip clip{.planes = {{{0, 0, 0}, {1, 0, 0}}}};
    expect_error(ErrorCode::InvalidInput, "cut", [&] { Splatter(volume, {.method = SplatMethod::Footprints, .clip = clip}); });
    Splatter splatter(volume, kFootprints);
    expect_error(ErrorCode::InvalidInput, "cut", [&] { splatter.set_clip(clip); });
    View ended({.eye = {0, 0, -5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 30}, 8, 8);
    ended.end_rays(std::vector<float>(64, 1.0F));
    expect_error(ErrorCode::InvalidInput, "cannot be ended", [&] {
        (void)splatter.draw(ended, Optics({.color = {{0, {1, 1, 1}}}, .opacity = {{0, .5}}}, 1));
    });
    RbfVolume separable = volume;
    separable.kernel = CubicConvolutionKernel{};
    expect_error(ErrorCode::InvalidInput, "radial", [&] { Splatter(separable, kFootprints); });
}

TEST(Footprints, OfThinVolumesAddUp) {
    // Each takes less of the light than a float next to 1 can tell.
    constexpr int kMany = 500;
    std::vector<Vec3> centers;
    for (int i = 0; i < kMany; ++i) centers.push_back({0, -1 + 2.0 * i / kMany, 0});
    const View view({.eye = {0, -10, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 2}, 3, 3);
    const auto opacity = [&](const std::vector<Vec3>& at, double unit) {
        const RbfVolume volume = kernels_at(at, std::vector<float>(at.size(), .5F), CompactKernel{.radius = 1.43});
        const Optics optics({.color = {{0, {1, 1, 1}}}, .opacity = {{0, .5}}}, unit);
        return double{render_splats(volume, view, optics, kFootprints).image.pixel(1, 1)[3]};
    };
    const double one = opacity({{0, 0, 0}}, 1e8);
    EXPECT_GT(one, 0);
    EXPECT_NEAR(opacity(centers, 1e8), kMany * one, 1e-4 * kMany * one);
}

}  // namespace footprints_test
}  // namespace subvol::test
