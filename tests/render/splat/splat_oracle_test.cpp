// SPDX-License-Identifier: Apache-2.0
// The splatter for CPUs against the readable oracle.
#include "splat_oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

#include "splat_scenes.h"

namespace subvol::test {
namespace splat_oracle_test {

// Sums are floats, right to 1e-6 of the range. The slope of the transfer function multiplies their error: one or two for the
// smooth one, .9 over 1/32 of the range for the sharp one.
constexpr double kSmooth = 1e-5, kSharp = 1e-4;

struct Look {
    bool sharp = false;
    Camera camera = perspective_camera();
    Emission emission = Emission::Preintegrated;
    double opacity_unit = 1;  // times the function's own
};

void expect_same(const RbfVolume& volume, const Look& look, SplatOptions options, double tolerance) {
    options.method = SplatMethod::Cpu;
    const View view(look.camera, 40, 37);  // the last tiles reach beyond the picture
    const Optics unscaled = look.sharp ? sharp_optics() : smooth_optics();
    const Optics optics(unscaled.function(), look.opacity_unit * unscaled.opacity_unit());
    const auto drawn = render_splats(volume, view, optics, options);
    const auto expected = draw_oracle(volume, view, optics, options, look.emission);
    double seen = 0, of_depth = 0;
    for (std::size_t i = 0; i < drawn.depth.size(); ++i) {
        const auto opacity = static_cast<double>(expected.image.rgba[4 * i + 3]);
        seen += opacity;
        EXPECT_EQ(std::isfinite(drawn.depth[i]), drawn.image.rgba[4 * i + 3] > 0);
        if (opacity < 0.01) continue;
        const double difference = static_cast<double>(drawn.depth[i]) - static_cast<double>(expected.depth[i]);
        of_depth = std::max(of_depth, opacity * std::abs(difference));  // a depth is a sum divided by the opacity
    }
    EXPECT_LT(largest_difference(drawn.image, expected.image), tolerance);
    EXPECT_LT(of_depth, std::max(tolerance, 1e-7 * glm::length(look.camera.eye)));  // floats, as seen from the eye
    EXPECT_GT(seen, .005 * static_cast<double>(drawn.depth.size())) << "the volume is in the picture";
}

RbfVolume ball(Correction correction = Correction::Second) {
    return sample_rbf_points(with_waves(nested_ball(2)), {.correction = correction}).volume;
}

RbfVolume ball_without_boundary(const Kernel& kernel) {
    RbfVolume volume = ball();
    volume.boundary = {};
    volume.kernel = kernel;
    return volume;
}

using Variant = std::tuple<bool, Correction, bool, bool>;

class SplatOracle : public testing::TestWithParam<Variant> {};

TEST_P(SplatOracle, AgreesForCompactKernels) {
    const auto [ball, correction, sharp, orthographic] = GetParam();
    const HexMesh mesh = with_waves(ball ? nested_ball(2) : jittered_box_about_origin());
    const auto volume = sample_rbf_points(mesh, {.correction = correction}).volume;
    expect_same(volume, {.sharp = sharp, .camera = orthographic ? orthographic_camera() : perspective_camera()}, {.sheets = 60},
                sharp ? kSharp : kSmooth);
}

std::string name_of(const testing::TestParamInfo<Variant>& info) {
    constexpr std::array kCorrections{"None", "Gradient", "Second", "Full"};
    const auto [ball, correction, sharp, orthographic] = info.param;
    return std::string(ball ? "Ball" : "Box") + kCorrections[static_cast<std::size_t>(correction)] +
           (sharp ? "Sharp" : "Smooth") + (orthographic ? "Orthographic" : "Perspective");
}

INSTANTIATE_TEST_SUITE_P(Each, SplatOracle,
                         testing::Combine(testing::Bool(),
                                          testing::Values(Correction::None, Correction::Gradient, Correction::Second,
                                                          Correction::Full),
                                          testing::Bool(), testing::Bool()),
                         name_of);

TEST(SplatOracle, AgreesForKernelsOfEveryShape) {
    const std::vector<Kernel> kernels{CompactKernel{},         GaussianKernel{},   BcSplineKernel{},
                                      WendlandC2Kernel{},      WendlandC4Kernel{}, SeparableGaussianKernel{},
                                      CubicConvolutionKernel{}};
    RbfVolume volume = ball(Correction::Full);
    for (const Kernel& kernel : kernels) {
        SCOPED_TRACE(to_json(kernel));
        const auto radius = static_cast<float>(support_radius(kernel) / support_radius(volume.kernel));
        for (auto& frame : volume.frames) {
            for (float& part : frame) part *= radius * radius;
        }
        volume.kernel = kernel;
        for (const bool sharp : {false, true}) {
            // The error of kernels' tables is at most 5e-6, five times that of rounding. Separable kernels have lobes of both
            // signs, so their sums have larger terms.
            const double tolerance = (is_radial(kernel) ? 1 : 3) * (sharp ? 2 * kSharp : kSmooth);
            expect_same(volume, {.sharp = sharp}, {.sheets = 24}, tolerance);
            expect_same(volume, {.sharp = sharp}, {.sheets = 24, .normalized = false}, tolerance);
        }
    }
}

TEST(SplatOracle, AgreesForASecondChannelsColors) {
    for (const Correction correction : {Correction::Second, Correction::Full}) {
        for (const bool sharp : {false, true}) {
            for (const bool normalized : {false, true}) {
                const SplatOptions options{.sheets = 30, .color_channel = 1, .normalized = normalized};
                expect_same(ball(correction), {.sharp = sharp}, options, sharp ? kSharp : kSmooth);
            }
        }
    }
}

TEST(SplatOracle, AgreesForLight) {
    for (const Correction correction : {Correction::Gradient, Correction::Full}) {
        for (const Camera& camera : {perspective_camera(), orthographic_camera()}) {
            for (const bool sharp : {false, true}) {
                SplatOptions options{.sheets = 30, .shading = Shading{}};
                expect_same(ball(correction), {.sharp = sharp, .camera = camera}, options, sharp ? kSharp : kSmooth);
                options.normalized = false;
                options.color_channel = 1;
                expect_same(ball(correction), {.sharp = sharp, .camera = camera}, options, sharp ? kSharp : kSmooth);
            }
        }
    }
}

TEST(SplatCpu, FlatFramesThatRoundingMadeIndefiniteLeaveThePictureFinite) {
    // Every second kernel is a disc that is seen from its face, or a needle across the view: floats cannot tell their frames
    // from indefinite ones, so they are valid.
    for (const Kernel& kernel : {Kernel(CompactKernel{}), Kernel(SeparableGaussianKernel{})}) {
        for (const Camera& camera : {perspective_camera(), orthographic_camera()}) {
            const View view(camera, 40, 37);
            const auto& [right, up, forward] = view.axes();
            RbfVolume volume = ball();
            volume.kernel = kernel;
            std::size_t indefinite = 0;
            for (std::size_t i = 0; i < volume.size(); i += 2) {
                const Vec3 along = .3 * (std::cos(double(i)) * right + std::sin(double(i)) * up);
                const Vec3 aside = i % 4 == 0 ? .3 * glm::cross(along, forward) : Vec3(0.0);
                volume.frames[i] = symmetric3(glm::outerProduct(along, along) + glm::outerProduct(aside, aside));
                indefinite += glm::dot(forward, matrix(volume.frames[i]) * forward) < 0 ? 1 : 0;
            }
            EXPECT_GT(indefinite, 5u);
            const auto drawn = render_splats(volume, view, smooth_optics(), {.method = SplatMethod::Cpu, .sheets = 30});
            EXPECT_TRUE(std::ranges::all_of(drawn.image.rgba, [](float v) { return std::isfinite(v) && v >= 0 && v <= 1; }));
        }
    }
}

TEST(SplatOracle, AgreesWithoutABoundary) {
    for (const Kernel& kernel : {Kernel(CompactKernel{}), Kernel(GaussianKernel{})}) {
        for (const Camera& camera : {perspective_camera(), orthographic_camera()}) {
            for (const bool sharp : {false, true}) {
                const SplatOptions options{.sheets = 40, .shading = plain_shading()};
                expect_same(ball_without_boundary(kernel), {.sharp = sharp, .camera = camera}, options,
                            sharp ? kSharp : 3 * kSmooth);  // the end of the volume is a quotient of differences of weights
            }
        }
    }
}

TEST(SplatOracle, AgreesWhereASheetBesideTheVolumeKnowsNothing) {
    // With few sheets, many have no weight where the volume has just ended: value, colour and light come from the other sheet.
    const RbfVolume volume = ball_without_boundary(CompactKernel{});
    for (const int sheets : {4, 8, 9, 10}) {
        SCOPED_TRACE(sheets);
        expect_same(volume, {}, {.sheets = sheets, .color_channel = 1}, 3 * kSmooth);
        expect_same(volume, {}, {.sheets = sheets, .shading = Shading{}}, 3 * kSmooth);
    }
}

TEST(SplatOracle, AgreesForFlatKernels) {
    // Flat along a skew direction, as cells in boundary layers are. Places are floats, 1e-7 of the width, and values and
    // lengths change three hundred times as fast through the thickness; a kernel's quadratic form would err by that factor
    // squared.
    constexpr double kFlat = 300;
    HexMesh mesh = with_waves(nested_ball(2));
    const Vec3 normal = glm::normalize(Vec3(1, -.7, .4));
    for (Vec3& p : mesh.points) p += (1 / kFlat - 1) * glm::dot(normal, p) * normal;
    Look look{.opacity_unit = 1 / kFlat};
    look.camera.eye = 3.0 * normal + 4.0 * glm::normalize(glm::cross(normal, Vec3(.2, .3, 1)));
    expect_same(sample_rbf_points(mesh).volume, look, {.sheets = 40}, kFlat * 1e-7);
}

TEST(SplatOracle, AgreesFromWithin) {
    const Camera within{.eye = {.1, .2, .05}, .target = {.5, 1, .2}, .up = {0, 0, 1}, .fovy_deg = 100};
    expect_same(ball(), {.camera = within}, {.sheets = 40}, kSmooth);
    expect_same(ball_without_boundary(CompactKernel{}), {.camera = within}, {.sheets = 40}, kSmooth);
}

TEST(SplatOracle, AgreesFromFarAway) {
    Camera camera = perspective_camera();
    camera.eye *= 1e4;
    camera.fovy_deg /= 1e4;
    expect_same(ball(), {.camera = camera}, {.sheets = 40}, kSmooth);
    expect_same(ball(), {.sharp = true, .camera = camera}, {.sheets = 40}, kSharp);
}

TEST(SplatOracle, EmissionIsMixedWithExtinctionToThirdOrder) {
    // On a stretch of optical depth t over which the colour changes by c, the exact light has t²c/12 more of the front's colour
    // than the even mixture. The smooth function: 60 stretches of 2/60 world lengths, τ up to 1.4, slopes of colour and value
    // of 2 and 1.
    expect_same(ball(), {.emission = Emission::Exact}, {.sheets = 60}, 60 * std::pow(1.4 / 30, 2) * (2. / 30) / 12);
}

}  // namespace splat_oracle_test
}  // namespace subvol::test
