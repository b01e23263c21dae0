// SPDX-License-Identifier: Apache-2.0
#include "gl_splatter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "lib/test_meshes.h"
#include "render/splat/splat_scenes.h"
#include "splat_cpu.h"
#include "subvol/error.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {
namespace gl_splatter_test {

using detail::Drawn;
using detail::GlSplatter;
using detail::GlTuning;

/// Nested cubes mapped onto the unit ball: irregular edges and vertices inside.
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

/// Peaks, ramps, and a gap without opacity between them.
Optics optics() {
    return Optics({.color = {{0, {0, 0, 1}}, {.5, {.1, 1, .2}}, {1, {1, 0, 0}}},
                   .opacity = {{0, 0}, {.2, .3}, {.3, 0}, {.42, 0}, {.5, .6}, {.6, .05}, {1, .3}}},
                  .3);
}

/// Most of the volume is invisible.
Optics one_shell() {
    return Optics({.color = {{0, {1, 1, .5}}}, .opacity = {{0, 0}, {.78, 0}, {.8, .7}, {.82, 0}, {1, 0}}}, .3);
}

View perspective(int width = 60, int height = 51) {
    return View({.eye = {1.5, -2.5, 1.2}, .target = {0, 0, 0}, .up = {0, 0, 1}}, width, height);
}
View orthographic() {
    return View({.eye = {1, -3, .7}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 2.2}, 49, 45);
}
View inside() {
    return View({.eye = {.2, -.3, .1}, .target = {0, 1, .2}, .up = {0, 0, 1}, .fovy_deg = 80}, 40, 33);
}

Drawn draw_on_cpu(const detail::SplatScene& scene, const View& view, const detail::Classification& classification, int sheets) {
    detail::SplatFrame frame;
    detail::prepare_frame(frame, scene, view, classification, sheets, nullptr);
    detail::find_interval_ends(frame);
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

/// Depths are quotients by the opacity, so their differences are weighted with it.
float largest_depth_difference(const Drawn& a, const Drawn& b) {
    float largest = 0;
    for (std::size_t i = 0; i < a.depth.size(); ++i) {
        if (a.depth[i] != b.depth[i]) largest = std::max(largest, a.image.rgba[4 * i + 3] * std::abs(a.depth[i] - b.depth[i]));
    }
    return largest;
}

RbfVolume sampled(Correction correction, const std::function<void(RbfVolume&)>& change = {}) {
    RbfVolume volume = sample_rbf_points(make_ball(), {.correction = correction}).volume;
    if (change) change(volume);
    return volume;
}

/// Gives a volume another kernel with the same reach.
void set_kernel(RbfVolume& volume, Kernel kernel) {
    const double scale = std::pow(support_radius(kernel) / support_radius(volume.kernel), 2);
    for (auto& frame : volume.frames) {
        for (float& f : frame) f *= static_cast<float>(scale);
    }
    volume.kernel = std::move(kernel);
}

class GlSplats : public testing::Test {
protected:
    void SetUp() override {
        if (!find_gl_device()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    }
};

constexpr int kSheets = 45;  // five batches and a part

// The same operations, some with another last bit, in sums of some ten kernels over 45 sheets: differences of a few 1e-7 were
// measured, also for depths.
constexpr float kRounding = 2e-6f, kDepthRounding = 1e-5f;

// In plain sums rounding does not cancel as in a quotient of two sums.
constexpr float kPlainRounding = 1e-5f;
// The end of the volume is a quotient of small differences of weights.
constexpr float kCutRounding = 2e-5f;

/// Draws every view on both backends.
void expect_like_cpu(const RbfVolume& volume, const SplatOptions& options, float most_color = kRounding) {
    const auto scene = detail::make_scene(volume, options);
    const auto classification = detail::classify(scene, optics());
    GlSplatter gpu(scene, {});
    for (const View& view : {perspective(), orthographic(), inside()}) {
        const Drawn cpu = draw_on_cpu(scene, view, classification, kSheets),
                    gl = gpu.draw(view, classification, kSheets, nullptr);
        const float color = largest_difference(cpu.image.rgba, gl.image.rgba);
        const float depth = largest_depth_difference(cpu, gl);
        EXPECT_LT(color, most_color);
        EXPECT_LT(depth, kDepthRounding);
        EXPECT_GT(std::accumulate(cpu.image.rgba.begin(), cpu.image.rgba.end(), 0.0), 300) << "the ball is in the picture";
    }
}

TEST_F(GlSplats, EveryCorrectionLooksAsOnTheCpu) {
    for (const Correction correction : {Correction::None, Correction::Second, Correction::Full}) {
        expect_like_cpu(sampled(correction), {});
    }
}

TEST_F(GlSplats, EveryKernelLooksAsOnTheCpu) {
    for (const Kernel& kernel : {Kernel(GaussianKernel{.radius = 2}), Kernel(SeparableGaussianKernel{.radius = 2})}) {
        expect_like_cpu(sampled(Correction::Second, [&](RbfVolume& v) { set_kernel(v, kernel); }), {});
    }
}

TEST_F(GlSplats, PlainSumsLookAsOnTheCpu) {
    expect_like_cpu(sampled(Correction::None, [](RbfVolume& v) { set_kernel(v, GaussianKernel{.radius = 2}); }),
                    {.normalized = false}, kPlainRounding);
}

TEST_F(GlSplats, ASecondChannelLooksAsOnTheCpu) {
    expect_like_cpu(sampled(Correction::Full), {.color_channel = 1});
}

TEST_F(GlSplats, ShadingLooksAsOnTheCpu) {
    expect_like_cpu(sampled(Correction::Full), {.shading = Shading{}});
    expect_like_cpu(sampled(Correction::Second), {.shading = plain_shading()});
}

TEST_F(GlSplats, WithoutABoundaryItLooksAsOnTheCpu) {
    expect_like_cpu(sampled(Correction::Second, [](RbfVolume& v) { v.boundary = {}; }), {}, kCutRounding);
}

TEST_F(GlSplats, TilesBatchesAndRepeatsChangeNoBit) {
    for (const bool bounded : {true, false}) {
        const RbfVolume volume = sampled(Correction::Second, [&](RbfVolume& v) {
            if (!bounded) v.boundary = {};
        });
        const auto scene = detail::make_scene(volume, {});
        GlSplatter reference(scene, {});
        std::vector<GlSplatter> others;
        for (const GlTuning& tuning :
             {GlTuning{.tile_px = 8}, GlTuning{.batch = 4}, GlTuning{.most_tiles = 3, .most_steps = 512},
              GlTuning{.tile_px = 8, .batch = 16, .most_tiles = 5, .most_steps = 1024}}) {
            others.emplace_back(scene, std::nullopt, tuning);
        }
        for (const auto& [view, seen] :
             {std::pair(perspective(), optics()), {perspective(), one_shell()}, {inside(), optics()}}) {
            const auto classification = detail::classify(scene, seen);
            const Drawn expected = reference.draw(view, classification, kSheets, nullptr);
            EXPECT_LT(largest_difference(draw_on_cpu(scene, view, classification, kSheets).image.rgba, expected.image.rgba),
                      kCutRounding);
            EXPECT_EQ(reference.draw(view, classification, kSheets, nullptr).image.rgba, expected.image.rgba);
            for (GlSplatter& other : others) {
                const Drawn drawn = other.draw(view, classification, kSheets, nullptr);
                EXPECT_EQ(drawn.image.rgba, expected.image.rgba);
                EXPECT_EQ(drawn.depth, expected.depth);
            }
        }
    }
}

TEST_F(GlSplats, AFineLayerHasTheSheetsThatItHasOnTheCpu) {
    const RbfVolume volume = sample_rbf_points(test::cube_with_layer()).volume;
    const View view({.eye = {-3, .9, 1.1}, .target = {0, .5, .5}, .up = {0, 0, 1}}, 72, 70);
    const auto scene = detail::make_scene(volume, {});
    const auto classification =
        detail::classify(scene, {{.color = {{0, {.1, .2, .9}}, {1, {.9, .8, .1}}}, .opacity = {{0, 0}, {1, .5}}}, .05});
    const Drawn cpu = draw_on_cpu(scene, view, classification, 0);
    GlSplatter reference(scene, {});
    const Drawn expected = reference.draw(view, classification, 0, nullptr);
    EXPECT_LT(largest_difference(cpu.image.rgba, expected.image.rgba), kPlainRounding);
    const Drawn without = reference.draw(view, classification, reference.report().sheets, nullptr);
    EXPECT_GT(largest_difference(without.image.rgba, expected.image.rgba), 1e-3f) << "there are more sheets";
    for (const GlTuning& tuning :
         {GlTuning{.tile_px = 8}, GlTuning{.tile_px = 8, .batch = 4}, GlTuning{.batch = 2},
          GlTuning{.batch = 4, .most_tiles = 3, .most_steps = 512},
          GlTuning{.batch = 4, .most_entries = reference.report().bin_entries / 3, .most_steps = 1024}}) {
        const Drawn drawn = GlSplatter(scene, {}, tuning).draw(view, classification, 0, nullptr);
        EXPECT_EQ(drawn.image.rgba, expected.image.rgba) << tuning.tile_px << " " << tuning.batch;
        EXPECT_EQ(drawn.depth, expected.depth);
    }
}

TEST_F(GlSplats, PassesChangeNoBit) {
    constexpr int kMany = 80;  // thin batches: each meets a third of the kernels
    for (const bool bounded : {true, false}) {
        const RbfVolume volume = sampled(Correction::Full, [&](RbfVolume& v) {
            if (!bounded) v.boundary = {};
        });
        const auto scene = detail::make_scene(volume, {.color_channel = 1});
        const auto classification = detail::classify(scene, optics());
        GlSplatter reference(scene, {});
        const Drawn expected = reference.draw(perspective(), classification, kMany, nullptr);
        EXPECT_EQ(reference.report().passes, 1);
        for (const GlTuning& tuning :
             {GlTuning{.most_entries = reference.report().bin_entries / 3},
              GlTuning{.batch = 4, .most_buffer_bytes = 64 * volume.size()},
              GlTuning{.most_entries = reference.report().bin_entries / 3, .most_tiles = 5, .most_steps = 512}}) {
            GlSplatter splatter(scene, {}, tuning);
            for (int repeat = 0; repeat < 2; ++repeat) {
                const Drawn drawn = splatter.draw(perspective(), classification, kMany, nullptr);
                EXPECT_GT(splatter.report().passes, 2);
                EXPECT_EQ(drawn.image.rgba, expected.image.rgba);
                EXPECT_EQ(drawn.depth, expected.depth);
            }
        }
        GlSplatter tiny(scene, {}, {.most_entries = 100});
        EXPECT_THROW((void)tiny.draw(perspective(), classification, kMany, nullptr), Error);
    }
}

TEST_F(GlSplats, OfOneCameraAreListedOnce) {
    RbfVolume volume = sampled(Correction::Second);
    const auto scene = detail::make_scene(volume, {});
    const auto some = detail::classify(scene, optics()), others = detail::classify(scene, one_shell());
    GlSplatter kept(scene, {});
    const auto expect = [&](const View& view, const detail::Classification& colors, int sheets, int lists) {
        const Drawn drawn = kept.draw(view, colors, sheets, nullptr);
        EXPECT_EQ(kept.report().lists, lists);
        const Drawn fresh = GlSplatter(scene, {}).draw(view, colors, sheets, nullptr);
        EXPECT_EQ(drawn.image.rgba, fresh.image.rgba);
        EXPECT_EQ(drawn.depth, fresh.depth);
        EXPECT_GT(kept.report().bin_entries, 0u);
    };
    expect(perspective(), some, kSheets, 1);
    expect(perspective(), others, kSheets, 0);
    expect(perspective(), some, kSheets, 0);
    expect(perspective(), some, kSheets - 1, 1);
    expect(orthographic(), some, kSheets, 1);
    for (auto& center : volume.centers) center *= .9;
    kept.upload_kernels();
    expect(orthographic(), some, kSheets, 1);
}

TEST_F(GlSplats, ThatTakeMoreThanTheMemoryAreDrawnInPasses) {
    const RbfVolume volume = sampled(Correction::Second);
    const auto scene = detail::make_scene(volume, {});
    const auto classification = detail::classify(scene, optics());
    // Half of the memory is for kernels of 160 bytes: nine of ten have room.
    GlSplatter reference(scene, {}), small(scene, {}, {.batch = 4, .memory_bytes = 288 * volume.size()});
    const Drawn expected = reference.draw(perspective(), classification, 80, nullptr),
                drawn = small.draw(perspective(), classification, 80, nullptr);
    EXPECT_GT(small.report().passes, 1);
    EXPECT_EQ(drawn.image.rgba, expected.image.rgba);
}

TEST_F(GlSplats, TilesWithTenThousandKernelsLookAsOnTheCpu) {
    // Mesa's software ends all loops of a thread after 65,535 iterations; a tile needs several times as many.
    HexMesh mesh = test::make_box(21, 21, 21);
    test::add_field(mesh, "f", [](const Vec3& p) { return .5 + .4 * std::sin(.3 * p.x) * std::cos(.2 * p.y) + .004 * p.z; });
    RbfVolume volume = sample_rbf_points(mesh, {.correction = Correction::Second}).volume;
    ASSERT_GT(volume.size(), 10000u);
    const View view({.eye = {50, -40, 35}, .target = {10.5, 10.5, 10.5}, .up = {0, 0, 1}}, 16, 16);
    const Optics optics({.color = {{0, {0, 0, 1}}, {1, {1, .5, 0}}}, .opacity = {{0, .05}, {1, .3}}}, 3);
    for (const bool bounded : {true, false}) {
        if (!bounded) volume.boundary = {};
        const auto scene = detail::make_scene(volume, {});
        const auto classification = detail::classify(scene, optics);
        GlSplatter gpu(scene, {});
        for (const int sheets : {5, 60}) {  // all kernels in one batch, whose sums are interrupted; in several
            const Drawn cpu = draw_on_cpu(scene, view, classification, sheets),
                        gl = gpu.draw(view, classification, sheets, nullptr);
            EXPECT_GT(gpu.report().dispatches, 1u);
            EXPECT_LT(largest_difference(cpu.image.rgba, gl.image.rgba), kCutRounding);
            EXPECT_GT(std::accumulate(cpu.image.rgba.begin(), cpu.image.rgba.end(), 0.0), 80) << "the box fills the picture";
        }
    }
}

TEST_F(GlSplats, AMillionKernelsLookAsOnTheCpu) {
    HexMesh mesh = test::make_box(100, 100, 100);
    test::add_field(mesh, "f", [](const Vec3& p) { return .5 + .4 * std::sin(.06 * p.x) * std::cos(.04 * p.y) + .001 * p.z; });
    const RbfVolume volume = sample_rbf_points(mesh, {.correction = Correction::None}).volume;
    ASSERT_GE(volume.size(), 1000000u);
    const View view({.eye = {250, -200, 175}, .target = {50, 50, 50}, .up = {0, 0, 1}}, 32, 32);
    const Optics optics({.color = {{0, {0, 0, 1}}, {1, {1, .5, 0}}}, .opacity = {{0, .05}, {1, .3}}}, 15);
    const auto scene = detail::make_scene(volume, {});
    const auto classification = detail::classify(scene, optics);
    GlSplatter gpu(scene, {});
    const Drawn cpu = draw_on_cpu(scene, view, classification, 12), gl = gpu.draw(view, classification, 12, nullptr);
    EXPECT_GT(gpu.report().bin_entries, volume.size());
    EXPECT_LT(largest_difference(cpu.image.rgba, gl.image.rgba), kCutRounding);
    EXPECT_GT(std::accumulate(cpu.image.rgba.begin(), cpu.image.rgba.end(), 0.0), 300) << "the box fills the picture";
}

TEST_F(GlSplats, TheWorkOfADispatchIsReported) {
    struct Fractions : Progress {
        void report(std::string_view stage, double fraction) override {
            if (stage == "splat") seen.push_back(fraction);
        }
        std::vector<double> seen;
    } progress;
    const RbfVolume volume = sampled(Correction::Second);
    const auto scene = detail::make_scene(volume, {});
    GlSplatter splatter(scene, {}, {.most_tiles = 4, .most_steps = 512});
    (void)splatter.draw(perspective(), detail::classify(scene, optics()), kSheets, &progress);
    EXPECT_GT(splatter.report().dispatches, 10u);
    EXPECT_GT(progress.seen.size(), splatter.report().dispatches);
    EXPECT_TRUE(std::is_sorted(progress.seen.begin(), progress.seen.end()));
    EXPECT_EQ(progress.seen.back(), 1);
}

TEST_F(GlSplats, PicturesDoNotDependOnEarlierOnes) {
    // Less, then more than there is room for, and another transfer function.
    const RbfVolume volume = sampled(Correction::Second);
    const auto scene = detail::make_scene(volume, {});
    const auto classification = detail::classify(scene, optics());
    GlSplatter kept(scene, {});
    for (const auto& [view, sheets] : {std::pair(orthographic(), 20), {perspective(), kSheets}, {inside(), 33}}) {
        const Drawn drawn = kept.draw(view, classification, sheets, nullptr),
                    fresh = GlSplatter(scene, {}).draw(view, classification, sheets, nullptr);
        EXPECT_EQ(drawn.image.rgba, fresh.image.rgba);
        EXPECT_EQ(drawn.depth, fresh.depth);
    }
}

TEST_F(GlSplats, TheDevicesOwnBoundaryIsThatOfTheCpu) {
    const RbfVolume volume = sampled(Correction::Second);
    const auto scene = detail::make_scene(volume, {});
    const auto classification = detail::classify(scene, optics());
    GlSplatter own(scene, {}, {.boundary_on_device = true}), from_cpu(scene, {});
    for (const auto& [view, sheets] : {std::pair(orthographic(), 20), {perspective(120, 90), 33}, {inside(), 33}}) {
        const Drawn drawn = own.draw(view, classification, sheets, nullptr),
                    expected = from_cpu.draw(view, classification, sheets, nullptr);
        EXPECT_EQ(own.report().boundary_hits, from_cpu.report().boundary_hits);
        EXPECT_LT(largest_difference(drawn.image.rgba, expected.image.rgba), kRounding);
    }
}

TEST_F(GlSplats, TheOrderOfKernelsMattersWithinRoundingOnly) {
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
        return render_splats(v, perspective(), optics(), {.method = SplatMethod::Gl, .sheets = kSheets}).image.rgba;
    };
    EXPECT_LT(largest_difference(draw(volume), draw(shuffled)), 5e-6f);  // sums of some ten kernels, over 45 sheets
}

TEST_F(GlSplats, RefusesADeviceThatIsNotThere) {
    const RbfVolume volume = sampled(Correction::None);
    EXPECT_THROW(Splatter(volume, {.method = SplatMethod::Gl, .device = 99}), Error);
    EXPECT_THROW(Splatter(volume, {.device = 99}), Error);
}

}  // namespace gl_splatter_test
}  // namespace subvol
