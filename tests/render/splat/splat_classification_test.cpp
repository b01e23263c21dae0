// SPDX-License-Identifier: Apache-2.0
// Values are reconstructed first and classified afterwards.
#include <gtest/gtest.h>

#include <random>

#include "lib/random_vector.h"
#include "splat_scenes.h"
#include "subvol/splat.h"

namespace subvol::test {
namespace splat_classification_test {

constexpr int kSize_px = 64;

TEST(SplatClassification, AValueBetweenTwoSamplesIsSeen) {
    // Values are 0 on one side of a box and 1 on the other; only values near 1/2 are visible.
    HexMesh cell = test::box(1);
    add_field(cell, "f", [](const Vec3& p) { return p.x; });
    const Optics optics({.color = {{0, {1, 1, 1}}, {1, {1, 1, 1}}}, .opacity = {{0, 0}, {.4, 0}, {.5, .9}, {.6, 0}, {1, 0}}},
                        .1);
    const View view({.eye = {.5, -4, .5}, .target = {.5, 0, .5}, .up = {0, 0, 1}, .ortho_height = 1}, kSize_px, kSize_px);
    const auto image = render_splats(sample_rbf_points(cell).volume, view, optics, {.method = SplatMethod::Cpu}).image;
    for (int x = 0; x < kSize_px; ++x) {
        const double value = (x + .5) / kSize_px;
        const double alpha = 1 - std::exp(-optics.extinction(value));
        EXPECT_NEAR(image.pixel(x, kSize_px / 2)[3], alpha, 1e-4) << value;  // an extinction of 23, over a tenth: slopes of 200
    }
    EXPECT_GT(image.pixel(kSize_px / 2, kSize_px / 2)[3], .99);
}

/// Forty Gaussians of different sizes and values that overlap in a cube.
RbfVolume cloud() {
    constexpr double kSigma = .43;
    std::mt19937 random(40);
    std::uniform_real_distribution<double> place(0, 1), size(.13, .2);
    std::uniform_real_distribution<float> value(0, 1);
    RbfVolume volume;
    volume.kernel = GaussianKernel{.sigma = kSigma, .amplitude = 1, .radius = 3};
    RbfChannel channel{.name = "f"};
    for (int i = 0; i < 40; ++i) {
        const double radius = 3 * size(random) / kSigma;
        const auto square = static_cast<float>(radius * radius);
        volume.centers.push_back(random_vector(place, random));
        volume.frames.push_back({square, 0, 0, square, 0, square});
        channel.values.push_back(value(random));
        channel.gradients.emplace_back();
        channel.moments.push_back(0);
    }
    volume.channels = {channel};
    volume.boundary = boundary_surface(test::box(1));
    return volume;
}

Optics two_peaks() {
    return Optics({.color = {{0, {.9, .2, .1}}, {.5, {.9, .9, .9}}, {1, {.1, .3, .9}}},
                   .opacity = {{0, 0}, {.25, 0}, {.3125, .5}, {.375, 0}, {.625, 0}, {.6875, .5}, {.75, 0}, {1, 0}}},
                  .05);
}

/// The same kernels with the colour and extinction of their own values, classified before they are added.
Image classified_by_kernel(const RbfVolume& volume, const View& view, const Optics& optics) {
    constexpr int kSteps = 256;
    Image image(view.width(), view.height());
    std::vector<Vec3> colors;
    std::vector<double> extinctions;
    for (const float value : volume.channels[0].values) {
        colors.push_back(optics.color(static_cast<double>(value)));
        extinctions.push_back(optics.extinction(static_cast<double>(value)));
    }
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            const Ray ray = view.ray(x + .5, y + .5);
            Segment seen;
            for (int step = 0; step < kSteps; ++step) {
                const Vec3 at = ray.origin + (2 + (step + .5) / kSteps) * ray.direction;  // the cube: at depths 2 to 3
                double weight = 0, extinction = 0;
                Vec3 emission(0.0);
                for (std::size_t i = 0; i < volume.size(); ++i) {
                    const Vec3 d = at - volume.centers[i];
                    const double w =
                        radial_value(volume.kernel, 3 * std::sqrt(glm::dot(d, d) / static_cast<double>(volume.frames[i][0])));
                    weight += w;
                    extinction += w * extinctions[i];
                    emission += w * extinctions[i] * colors[i];
                }
                if (extinction == 0) continue;
                const double passes = std::exp(-extinction / weight / kSteps);
                composite(seen, {(1 - passes) / extinction * emission, passes});
            }
            const auto pixel = image.pixel(x, y);
            for (int c = 0; c < 3; ++c) pixel[static_cast<std::size_t>(c)] = static_cast<float>(seen.color[c]);
            pixel[3] = static_cast<float>(1 - seen.transmittance);
        }
    }
    return image;
}

TEST(SplatClassification, ClassifyingTheSumBeatsClassifyingKernels) {
    const RbfVolume volume = cloud();
    const Optics optics = two_peaks();
    // All rays go through the whole cube.
    const View view({.eye = {.5, -2, .5}, .target = {.5, 0, .5}, .up = {0, 0, 1}, .ortho_height = 1}, kSize_px, kSize_px);
    const auto draw = [&](int sheets) {
        return render_splats(volume, view, optics, {.method = SplatMethod::Cpu, .sheets = sheets}).image;
    };
    const Image exact = draw(2049);
    const double by_kernel = rmse(classified_by_kernel(volume, view, optics), exact);
    const double at_17 = rmse(draw(17), exact), at_33 = rmse(draw(33), exact), at_65 = rmse(draw(65), exact);
    EXPECT_GT(by_kernel, .05);
    EXPECT_LT(at_17, by_kernel / 10);
    // Second order: the error falls to a quarter, or below while peaks are thinner than the distance of sheets.
    EXPECT_LT(at_33, at_17 / 3.3);
    EXPECT_LT(at_65, at_33 / 3.3);
}

TEST(SplatClassification, ColorsOfASecondChannelAndLightAreOfSecondOrder) {
    const RbfVolume volume = sample_rbf_points(with_waves(nested_ball(4)), {.correction = Correction::Full}).volume;
    const View view(perspective_camera(), kSize_px, kSize_px);
    const SplatOptions options{.method = SplatMethod::Cpu, .color_channel = 1, .shading = Shading{}};
    const auto draw = [&](int sheets) {
        SplatOptions with = options;
        with.sheets = sheets;
        return render_splats(volume, view, smooth_optics(), with).image;
    };
    const Image exact = draw(2049);
    const double coarse = rmse(draw(33), exact), fine = rmse(draw(65), exact);
    EXPECT_GT(coarse / fine, 3.3);
}

}  // namespace splat_classification_test
}  // namespace subvol::test
