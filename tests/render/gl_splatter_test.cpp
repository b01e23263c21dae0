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
    expect_like_cpu(sampled(Correction::None, [](RbfVolume& v) { set_kernel(v, GaussianKernel{}); }), {.normalized = false}, 1e-5f,
                    1e-4f);
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

}  // namespace
}  // namespace subvol
