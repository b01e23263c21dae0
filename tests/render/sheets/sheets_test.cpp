// SPDX-License-Identifier: Apache-2.0
// Sheet buffers against the CPU: both follow the same rules, so the pictures differ by rounding only.
#include <gtest/gtest.h>

#include <cmath>

#include "gl_context.h"
#include "lib/comma_locale.h"
#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {
namespace sheets_test {

/// The largest and the RMS difference of two linear pictures, and their mean brightness.
struct Difference {
    double largest = 0, rms = 0, mean = 0;
};

Difference compare(const Image& a, const Image& b) {
    Difference d;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) {
        const double one = std::abs(double(a.rgba[i]) - double(b.rgba[i]));
        d.largest = std::max(d.largest, one);
        d.rms += one * one;
        d.mean += double(a.rgba[i]);
    }
    d.rms = std::sqrt(d.rms / double(a.rgba.size()));
    d.mean /= double(a.rgba.size());
    return d;
}

class Sheets : public testing::Test {
protected:
    void SetUp() override {
        try {
            const detail::GlContext context;
        } catch (const Error& error) {
            GTEST_SKIP() << error.what();
        }
    }

    static SplatResult sheets(const RbfVolume& volume, const View& view, const Optics& optics, SplatOptions options = {}) {
        options.method = SplatMethod::Sheets;
        return render_splats(volume, view, optics, options);
    }

    static void expect_as_cpu(const std::string& what, const RbfVolume& volume, const View& view, const Optics& optics,
                              SplatOptions options = {}) {
        const auto drawn = sheets(volume, view, optics, options);
        options.method = SplatMethod::Cpu;
        options.sheets = drawn.report.sheets;  // and no more where kernels are thin, as sheet buffers are of whole pictures
        const auto cpu = render_splats(volume, view, optics, options);
        const Difference d = compare(drawn.image, cpu.image);
        RecordProperty(what + " largest", std::to_string(d.largest));
        // The same operations with other rounding: floats of 24 bits, 200 sheets, slopes of transfer functions up to 30.
        // Measured with Mesa's software: 1.5e-5 at most, 4e-7 in the mean.
        EXPECT_LT(d.largest, 1e-4) << what;
        EXPECT_LT(d.rms, 1e-5) << what;
        EXPECT_GT(d.mean, .01) << what << ": something is in the picture";
        for (std::size_t i = 0; i < cpu.depth.size(); ++i) {
            if (cpu.image.rgba[4 * i + 3] < .01f) continue;  // the mean is divided by hardly any opacity
            ASSERT_NEAR(drawn.depth[i], cpu.depth[i], 1e-3) << what << ", pixel " << i;
        }
    }

    /// Sharp: a surface, on which every ripple is visible.
    static Optics optics(bool sharp) {
        TransferFunction f{.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}},
                           .opacity = {{-1, .30}, {-.3, .05}, {0, 0}, {.3, .05}, {1, .40}}};
        if (sharp) f.opacity = {{-1, 0}, {.27, 0}, {.30, .9}, {.33, 0}, {1, 0}};
        return {f, 0.1};
    }

    /// Irregular inside, curved outside; fields f and g.
    static HexMesh ball() {
        HexMesh mesh = test::make_nested_cubes(4);
        for (auto& p : mesh.points) {
            const double cube = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
            if (cube > 0) p *= (1 - cube) + cube * cube / glm::length(p);
        }
        test::add_field(mesh, "f", [](const Vec3& p) { return .8 * std::sin(3 * p.x) * std::cos(2 * p.y) + .2 * p.z; });
        test::add_field(mesh, "g", [](const Vec3& p) { return .7 * std::cos(2 * p.x + p.z) - .2 * p.y; });
        return mesh;
    }

    static RbfVolume sampled_ball(Correction correction, const Kernel& kernel = {}) {
        return sample_rbf_points(ball(), {.correction = correction, .kernel = kernel}).volume;
    }

    static View view(int width = 100, int height = 90) {
        return {{.eye = {2, -3, 1.5}, .target = {0, 0, 0}, .up = {0, 0, 1}}, width, height};
    }
};

TEST_F(Sheets, DrawTheIrregularBallAsTheCpuDoes) {
    expect_as_cpu("no correction", sampled_ball(Correction::None), view(), optics(false));
    expect_as_cpu("second order", sampled_ball(Correction::Second), view(), optics(false));
    expect_as_cpu("second order, sharp", sampled_ball(Correction::Second), view(), optics(true));
    expect_as_cpu("Hessians", sampled_ball(Correction::Full), view(), optics(false));
}

TEST_F(Sheets, DrawTheTwistedBlockAsTheCpuDoes) {
    const auto volume = sample_rbf_points(make_model("twist", 16)).volume;
    const View from_far({.eye = {2.6, -4.2, 2.0}, .target = {-.55, 0, 0}, .up = {0, 0, 1}}, 128, 128);
    expect_as_cpu("smooth", volume, from_far, optics(false));
    expect_as_cpu("sharp", volume, from_far, optics(true));
    const View straight({.eye = {0, -10, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = 2.5}, 120, 100);
    expect_as_cpu("orthographic", volume, straight, optics(true));
    // Kernels reach beyond the picture on all sides, and before the eye.
    const View inside({.eye = {.1, -.2, .1}, .target = {-1, .5, .2}, .up = {0, 0, 1}}, 90, 110);
    expect_as_cpu("from inside", volume, inside, optics(false));
}

TEST_F(Sheets, DrawLightTheSecondColorAndPlainSumsAsTheCpuDoes) {
    const auto volume = sampled_ball(Correction::Second), full = sampled_ball(Correction::Full);
    expect_as_cpu("light", volume, view(), optics(true), {.shading = Shading{}});
    expect_as_cpu("second color", volume, view(), optics(false), {.color_channel = 1});
    expect_as_cpu("all at once", full, view(), optics(false), {.color_channel = 1, .shading = plain_shading()});
    expect_as_cpu("plain sums", volume, view(), optics(false), {.normalized = false});
}

TEST_F(Sheets, DrawEveryKernelAsTheCpuDoes) {
    expect_as_cpu("Gaussian", sampled_ball(Correction::Second, GaussianKernel{}), view(), optics(false));
    expect_as_cpu("BC spline", sampled_ball(Correction::None, BcSplineKernel{}), view(), optics(false));
    auto separable = sampled_ball(Correction::Second, GaussianKernel{});
    separable.kernel = SeparableGaussianKernel{};  // in the same frames
    expect_as_cpu("separable", separable, view(), optics(false));
}

TEST_F(Sheets, EndWhereTheCpuEndsWithoutABoundary) {
    auto volume = sampled_ball(Correction::Second);
    volume.boundary = {};
    expect_as_cpu("no boundary", volume, view(), optics(false));
}

TEST_F(Sheets, ShowAConstantFieldAsThatConstant) {
    HexMesh box = test::make_box(4, 3, 4);
    test::add_field(box, "f", [](const Vec3&) { return .7; });
    const Optics fog({.color = {{0, {1, .5, .25}}, {1, {1, .5, .25}}}, .opacity = {{0, .3}, {1, .3}}}, 1.5);
    const View straight({.eye = {2, -10, 2}, .target = {2, 0, 2}, .up = {0, 0, 1}, .ortho_height = 6}, 64, 64);
    const auto image = sheets(sample_rbf_points(box).volume, straight, fog).image;
    const double alpha = 1 - std::pow(1 - .3, 3 / 1.5);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            const bool inside = x >= 11 && x < 53 && y >= 11 && y < 53;  // the box covers pixels 10.67 to 53.33
            EXPECT_NEAR(image.pixel(x, y)[3], inside ? alpha : 0, 2e-6) << x << ' ' << y;  // float rounding of 200 products
            EXPECT_NEAR(image.pixel(x, y)[1], inside ? .5 * alpha : 0, 2e-6) << x << ' ' << y;
        }
    }
}

TEST_F(Sheets, AndComputeShadersDrawThinSlabsAsTheCpuDoes) {
    // A thousandth as thick as wide: between two sheets, or cut by one of them on a slant; kernels are as flat.
    HexMesh slab = test::make_box(6, 6, 1);
    test::add_field(slab, "f", [](const Vec3& p) { return .8 * std::sin(p.x) * std::cos(p.y); });
    for (Vec3& p : slab.points) p = Vec3(p.x / 3 - 1, p.y / 3 - 1, .002 * p.z);
    const auto volume = sample_rbf_points(slab).volume;
    const Optics dense(optics(false).function(), .001);
    for (const Vec3& eye : {Vec3(2, -3, 1.5), Vec3(.3, -4, .02), Vec3(0, 0, 4)}) {
        const View from({.eye = eye, .target = {0, 0, 0}, .up = {.1, 1, .3}}, 80, 64);
        const auto cpu = render_splats(volume, from, dense, {.method = SplatMethod::Cpu, .sheets = 30});
        for (const SplatMethod method : {SplatMethod::Gl, SplatMethod::Sheets}) {
            const auto drawn = render_splats(volume, from, dense, {.method = method, .sheets = 30});
            EXPECT_LT(compare(drawn.image, cpu.image).largest, 1e-3) << "depths of single precision beside a thickness of .002";
        }
        EXPECT_GT(compare(cpu.image, cpu.image).mean, .001) << "something is in the picture";
    }
}

TEST_F(Sheets, WithTenThousandKernelsOnAPixelAreDrawnAsTheCpuDoes) {
    HexMesh mesh = test::make_box(21, 21, 21);
    test::add_field(mesh, "f", [](const Vec3& p) { return .5 * std::sin(.3 * p.x) * std::cos(.2 * p.y); });
    const auto volume = sample_rbf_points(mesh).volume;
    ASSERT_GT(volume.size(), 10000u);
    const View far({.eye = {50, -40, 35}, .target = {10.5, 10.5, 10.5}, .up = {0, 0, 1}}, 8, 8);
    expect_as_cpu("ten thousand", volume, far, Optics(optics(false).function(), 3));
}

TEST_F(Sheets, AreTheSameInEveryLocale) {
    const auto volume = sampled_ball(Correction::Second);
    const auto image = sheets(volume, view(), optics(false)).image;
    const test::CommaLocale comma;  // the shaders' texts have numbers in them
    EXPECT_EQ(sheets(volume, view(), optics(false)).image.rgba, image.rgba);
}

TEST_F(Sheets, ArePixelForPixelTheSameEveryTime) {
    const auto volume = sampled_ball(Correction::Second);
    const auto first = sheets(volume, view(), optics(true)).image;
    EXPECT_EQ(first.rgba, sheets(volume, view(), optics(true)).image.rgba);
    // Larger and smaller pictures that were drawn before do not matter.
    Splatter splatter(volume, {.method = SplatMethod::Sheets});
    (void)splatter.draw(view(40, 30), optics(false));
    (void)splatter.draw(view(140, 130), optics(false));
    EXPECT_EQ(first.rgba, splatter.draw(view(), optics(true)).image.rgba);
}

}  // namespace sheets_test
}  // namespace subvol
