#include "gl_splatter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/sample.h"

namespace subvol {
namespace {

using detail::Drawn;
using detail::GlSplatter;
using detail::GlTuning;

/// Nested cubes drawn onto the unit ball: irregular edges and vertices inside.
HexMesh make_ball() {
    HexMesh mesh = test::make_nested_cubes(4);
    for (auto& p : mesh.points) {
        const double cube = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        if (cube > 0) p *= (1 - cube) + cube * cube / glm::length(p);
    }
    test::add_field(mesh, "f", [](const Vec3& p) { return .5 + .4 * std::sin(3 * p.x) * std::cos(2 * p.y) + .1 * p.z; });
    test::add_field(mesh, "g", [](const Vec3& p) { return p.x + .5 * p.z; });
    return mesh;
}

/// Peaks, ramps, and a gap without opacity between.
Optics optics() {
    return Optics({.color = {{0, {0, 0, 1}}, {.5, {.1, 1, .2}}, {1, {1, 0, 0}}},
                   .opacity = {{0, 0}, {.2, .3}, {.3, 0}, {.42, 0}, {.5, .6}, {.6, .05}, {1, .3}}},
                  .3);
}

View perspective(int width = 90, int height = 77) {
    return View({.eye = {1.5, -2.5, 1.2}, .target = {0, 0, 0}, .up = {0, 0, 1}}, width, height);
}
View orthographic() {
    return View({.eye = {1, -3, .7}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 2.2}, 70, 81);
}
View inside() {
    return View({.eye = {.2, -.3, .1}, .target = {0, 1, .2}, .up = {0, 0, 1}, .fovy_deg = 80}, 64, 50);
}

Drawn draw_on_cpu(const detail::SplatScene& scene, const View& view, const detail::Classification& look, int sheets) {
    detail::SplatFrame frame;
    detail::prepare_frame(frame, scene, view, look, sheets, nullptr);
    return detail::draw_splats_cpu(frame, nullptr);
}

float largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    float largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i] != b[i]) largest = std::max(largest, std::abs(a[i] - b[i]));
    }
    return largest;
}

struct Case {
    std::string name;
    RbfVolume volume;
    SplatOptions options{};
};

RbfVolume sampled(Correction correction, const std::function<void(RbfVolume&)>& change = {}) {
    RbfVolume volume = sample_rbf_points(make_ball(), {.correction = correction}).volume;
    if (change) change(volume);
    return volume;
}

/// Gives a volume another kernel of the same reach.
void set_kernel(RbfVolume& volume, Kernel kernel) {
    const double scale = std::pow(support_radius(kernel) / support_radius(volume.kernel), 2);
    for (auto& frame : volume.frames) {
        for (float& f : frame) f *= static_cast<float>(scale);
    }
    volume.kernel = std::move(kernel);
}

class GlSplatterTest : public testing::Test {
protected:
    void SetUp() override {
        if (!find_gl_device()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    }
};

/// Draws every view on both backends.
void expect_like_cpu(const RbfVolume& volume, const SplatOptions& options, float most_color, float most_depth) {
    const auto scene = detail::make_scene(volume, options);
    const auto look = detail::classify(scene, optics());
    GlSplatter gpu(scene, {});
    for (const View& view : {perspective(), orthographic(), inside()}) {
        const Drawn cpu = draw_on_cpu(scene, view, look, 60), gl = gpu.draw(view, look, 60, nullptr);
        const float color = largest_difference(cpu.image.rgba, gl.image.rgba);
        const float depth = largest_difference(cpu.depth, gl.depth);
        EXPECT_LT(color, most_color);
        EXPECT_LT(depth, most_depth);
        std::printf("    colour %.2e, depth %.2e\n", double(color), double(depth));
        EXPECT_GT(std::accumulate(cpu.image.rgba.begin(), cpu.image.rgba.end(), 0.0), 1000) << "the ball is in the picture";
    }
}

TEST_F(GlSplatterTest, EveryCorrectionLooksAsOnTheCpu) {
    for (const Correction correction : {Correction::None, Correction::Second, Correction::Full}) {
        expect_like_cpu(sampled(correction), {}, 1e-5f, 1e-4f);
    }
}

TEST_F(GlSplatterTest, EveryKernelLooksAsOnTheCpu) {
    for (const Kernel& kernel : {Kernel(GaussianKernel{}), Kernel(SeparableGaussianKernel{})}) {
        expect_like_cpu(sampled(Correction::Second, [&](RbfVolume& v) { set_kernel(v, kernel); }), {}, 1e-5f, 1e-4f);
    }
}

TEST_F(GlSplatterTest, PlainSumsLookAsOnTheCpu) {
    expect_like_cpu(sampled(Correction::None, [](RbfVolume& v) { set_kernel(v, GaussianKernel{}); }), {.normalized = false},
                    1e-5f, 1e-4f);
}

TEST_F(GlSplatterTest, ASecondChannelLooksAsOnTheCpu) {
    expect_like_cpu(sampled(Correction::Full), {.color_channel = 1}, 1e-5f, 1e-4f);
}

TEST_F(GlSplatterTest, ShadingLooksAsOnTheCpu) {
    expect_like_cpu(sampled(Correction::Full), {.shading = Shading{}}, 1e-5f, 1e-4f);
    expect_like_cpu(sampled(Correction::Second), {.shading = Shading{}}, 1e-5f, 1e-4f);
}

TEST_F(GlSplatterTest, WithoutABoundaryItLooksAsOnTheCpu) {
    expect_like_cpu(sampled(Correction::Second, [](RbfVolume& v) { v.boundary = {}; }), {}, 1e-5f, 1e-4f);
}

TEST_F(GlSplatterTest, TilesBatchesAndRepeatsChangeNoBit) {
    for (const bool bounded : {true, false}) {
        const RbfVolume volume = sampled(Correction::Second, [&](RbfVolume& v) {
            if (!bounded) v.boundary = {};
        });
        const auto scene = detail::make_scene(volume, {});
        const auto look = detail::classify(scene, optics());
        for (const View& view : {perspective(), inside()}) {
            GlSplatter reference(scene, {});
            const Drawn expected = reference.draw(view, look, 61, nullptr);
            EXPECT_EQ(reference.draw(view, look, 61, nullptr).image.rgba, expected.image.rgba);
            for (const GlTuning& tuning : {GlTuning{.tile_px = 8}, GlTuning{.batch = 4}, GlTuning{.tile_px = 8, .batch = 16}}) {
                const Drawn drawn = GlSplatter(scene, {}, tuning).draw(view, look, 61, nullptr);
                EXPECT_EQ(drawn.image.rgba, expected.image.rgba) << tuning.tile_px << " px, " << tuning.batch << " sheets";
                EXPECT_EQ(drawn.depth, expected.depth);
            }
        }
    }
}

TEST_F(GlSplatterTest, PassesChangeNoBit) {
    for (const bool bounded : {true, false}) {
        const RbfVolume volume = sampled(Correction::Full, [&](RbfVolume& v) {
            if (!bounded) v.boundary = {};
        });
        const auto scene = detail::make_scene(volume, {.color_channel = 1});
        const auto look = detail::classify(scene, optics());
        GlSplatter reference(scene, {});
        const Drawn expected = reference.draw(perspective(), look, 61, nullptr);
        EXPECT_EQ(reference.report().passes, 1);
        for (const GlTuning& tuning : {GlTuning{.most_entries = reference.report().bin_entries / 3},
                                       GlTuning{.batch = 4, .most_buffer_bytes = 64 * volume.size()}}) {
            GlSplatter splatter(scene, {}, tuning);
            for (int repeat = 0; repeat < 2; ++repeat) {
                const Drawn drawn = splatter.draw(perspective(), look, 61, nullptr);
                EXPECT_GT(splatter.report().passes, 2);
                EXPECT_EQ(drawn.image.rgba, expected.image.rgba);
                EXPECT_EQ(drawn.depth, expected.depth);
            }
        }
        GlSplatter tiny(scene, {}, {.most_entries = 100});
        EXPECT_THROW((void)tiny.draw(perspective(), look, 61, nullptr), Error);
    }
}

TEST_F(GlSplatterTest, WhatThePictureBeforeLeftDoesNotMatter) {
    // Less, then more than there is room for, and another transfer function.
    const RbfVolume volume = sampled(Correction::Second);
    const auto scene = detail::make_scene(volume, {});
    const auto look = detail::classify(scene, optics());
    GlSplatter kept(scene, {});
    for (const auto& [view, sheets] : {std::pair(orthographic(), 20), {perspective(), 61}, {inside(), 33}}) {
        const Drawn drawn = kept.draw(view, look, sheets, nullptr),
                    fresh = GlSplatter(scene, {}).draw(view, look, sheets, nullptr);
        EXPECT_EQ(drawn.image.rgba, fresh.image.rgba);
        EXPECT_EQ(drawn.depth, fresh.depth);
    }
}

TEST_F(GlSplatterTest, TheOrderOfKernelsMattersWithinRoundingOnly) {
    const RbfVolume volume = sampled(Correction::Second);
    std::vector<std::size_t> order(volume.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    RbfVolume shuffled = volume;
    for (std::size_t i = 0; i < order.size(); ++i) {
        shuffled.centers[i] = volume.centers[order[i]];
        shuffled.frames[i] = volume.frames[order[i]];
        shuffled.channels[0].values[i] = volume.channels[0].values[order[i]];
        shuffled.channels[0].gradients[i] = volume.channels[0].gradients[order[i]];
        shuffled.channels[0].moments[i] = volume.channels[0].moments[order[i]];
    }
    const auto draw = [&](const RbfVolume& v) {
        return render_splats(v, perspective(), optics(), {.backend = Backend::Gl, .sheets = 60}).image.rgba;
    };
    EXPECT_LT(largest_difference(draw(volume), draw(shuffled)), 5e-6f);  // sums of some ten kernels, over 60 sheets
}

TEST_F(GlSplatterTest, RefusesADeviceThatIsNotThere) {
    const RbfVolume volume = sampled(Correction::None);
    EXPECT_THROW(Splatter(volume, {.backend = Backend::Gl, .device = 99}), Error);
    EXPECT_THROW(Splatter(volume, {.device = 99}), Error);
}

}  // namespace
}  // namespace subvol
