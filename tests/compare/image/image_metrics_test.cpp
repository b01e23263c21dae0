// SPDX-License-Identifier: Apache-2.0
#include "subvol/image_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/comma_locale.h"
#include "subvol/error.h"

namespace subvol {
namespace image_metrics_test {

Image uniform_image(int width, int height, float value) {
    Image image(width, height);
    std::fill(image.rgba.begin(), image.rgba.end(), value);
    return image;
}

double luminance(std::span<const float, 4> pixel) {
    return 0.2126 * static_cast<double>(pixel[0]) + 0.7152 * static_cast<double>(pixel[1]) +
           0.0722 * static_cast<double>(pixel[2]);
}

TEST(ImageMetrics, ConstantDifference) {
    const auto metrics = compare_images(uniform_image(33, 17, 0.75f), uniform_image(33, 17, 0.5f));
    constexpr double kDifference = 0.25;  // exact in floats, as are its square and the sums
    EXPECT_EQ(metrics.mse, kDifference * kDifference);
    EXPECT_EQ(metrics.rmse, kDifference);
    EXPECT_EQ(metrics.mae, kDifference);
    EXPECT_EQ(metrics.max, kDifference);
    EXPECT_NEAR(metrics.psnr, -20 * std::log10(kDifference), 1e-12);  // rounding of two logarithms
}

TEST(ImageMetrics, OneChannelOfOnePixel) {
    const Image a(10, 5);
    Image b = a;
    b.pixel(3, 2)[1] = 0.5f;
    const auto metrics = compare_images(a, b);
    EXPECT_DOUBLE_EQ(metrics.mse, 0.25 / 150);
    EXPECT_DOUBLE_EQ(metrics.mae, 0.5 / 150);
    EXPECT_EQ(metrics.max, 0.5);
}

TEST(ImageMetrics, AlphaDoesNotCount) {
    const Image a(4, 4);
    Image b = a;
    for (std::size_t i = 3; i < b.rgba.size(); i += 4) b.rgba[i] = 1.0f;
    EXPECT_EQ(compare_images(a, b).max, 0.0);
}

TEST(ImageMetrics, EqualImages) {
    const auto metrics = compare_images(uniform_image(8, 8, 0.3f), uniform_image(8, 8, 0.3f));
    EXPECT_EQ(metrics.rmse, 0.0);
    EXPECT_EQ(metrics.max, 0.0);
    EXPECT_EQ(metrics.psnr, std::numeric_limits<double>::infinity());
}

TEST(ImageMetrics, NotANumberShows) {
    const Image a(4, 4);
    Image b = a;
    b.pixel(1, 1)[0] = std::numeric_limits<float>::quiet_NaN();
    const auto metrics = compare_images(a, b);
    EXPECT_TRUE(std::isnan(metrics.rmse));
    EXPECT_TRUE(std::isnan(metrics.mae));
    EXPECT_TRUE(std::isnan(metrics.max));
    EXPECT_TRUE(std::isnan(metrics.psnr));
}

TEST(ImageMetrics, SizesMustAgree) {
    EXPECT_THROW((void)compare_images(Image(4, 4), Image(4, 5)), Error);
    EXPECT_THROW((void)compare_images(Image(2, 8), Image(4, 4)), Error);
    EXPECT_THROW((void)compare_images(Image(), Image()), Error);
    EXPECT_THROW((void)difference_heatmap(Image(4, 4), Image(5, 4)), Error);
    EXPECT_THROW((void)difference_heatmap(Image(4, 4), Image(4, 4), -1), Error);
}

TEST(DifferenceHeatmap, BrighterWhereTheDifferenceIsLarger) {
    const int width = 200;
    const Image a(width, 8);
    Image b = a;
    for (int x = 0; x < width; ++x) b.pixel(x, 3)[2] = static_cast<float>(x) / (width - 1);
    const Image heat = difference_heatmap(a, b);
    ASSERT_EQ(heat.width, width);
    ASSERT_EQ(heat.height, 8 + 30);
    for (int x = 1; x < width; ++x) EXPECT_GT(luminance(heat.pixel(x, 3)), luminance(heat.pixel(x - 1, 3)));
    EXPECT_LT(luminance(heat.pixel(100, 0)), 1e-3);       // no difference: the first colour
    EXPECT_GT(luminance(heat.pixel(width - 1, 3)), 0.9);  // the largest: the last colour
    for (std::size_t i = 3; i < heat.rgba.size(); i += 4) ASSERT_EQ(heat.rgba[i], 1.0f);
    // The bar of the legend has the same colours as this ramp.
    for (int x = 0; x < width; ++x) {
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(heat.pixel(x, 10)[c], heat.pixel(x, 3)[c], 1e-5);  // float ramp
    }
}

TEST(DifferenceHeatmap, ScaleIsTheLastColour) {
    const Image heat = difference_heatmap(Image(100, 4), uniform_image(100, 4, 0.5f), 0.5);
    const Image beyond = difference_heatmap(Image(100, 4), uniform_image(100, 4, 5.0f), 0.5);
    EXPECT_EQ(heat.rgba, beyond.rgba);
    EXPECT_GT(luminance(heat.pixel(0, 0)), 0.9);
}

TEST(DifferenceHeatmap, NumbersTellTheScale) {
    const auto legend_of = [](double scale) {
        const Image heat = difference_heatmap(Image(120, 4), uniform_image(120, 4, 0.1f), scale);
        return std::vector<float>(heat.rgba.begin() + 4 * 120 * (4 + 12), heat.rgba.end());
    };
    EXPECT_NE(legend_of(0.5), legend_of(0.25));
    const auto quarter = legend_of(0.25);
    const test::CommaLocale comma;
    EXPECT_EQ(legend_of(0.25), quarter) << "there is no glyph for a decimal comma";
    const auto legend = legend_of(0.5);
    EXPECT_GT(std::count(legend.begin(), legend.end(), 1.0f), 120 * 18);  // more than the alpha values alone
}

TEST(DifferenceHeatmap, EqualAndTinyImages) {
    const Image equal = difference_heatmap(uniform_image(50, 2, 0.5f), uniform_image(50, 2, 0.5f));
    EXPECT_LT(luminance(equal.pixel(25, 1)), 1e-3);
    const Image tiny = difference_heatmap(Image(1, 1), uniform_image(1, 1, 1.0f));
    EXPECT_EQ(tiny.width, 1);
    EXPECT_GT(luminance(tiny.pixel(0, 0)), 0.9);
}

TEST(Heatmap, OfACommonScaleHasTheSameColoursInEveryPicture) {
    // Of two maps with other largest values the same value has the same colour, a difference of 1e-4 is black.
    MetricMap low(64, 2), high(64, 2);
    for (float& value : low.values) value = .01f;
    for (float& value : high.values) value = .5f;
    high.at(3, 0) = .01f;
    high.at(4, 0) = 5e-5f;
    const Image a = log_heatmap(low), b = log_heatmap(high);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(a.pixel(3, 0)[c], b.pixel(3, 0)[c]);
        EXPECT_LT(b.pixel(4, 0)[c], .01f);
    }
    EXPECT_GT(b.pixel(10, 0)[0], a.pixel(10, 0)[0]);
    EXPECT_THROW((void)log_heatmap(MetricMap()), Error);
}

TEST(Heatmap, OfSignsIsOrangeWhereItIsTooBright) {
    const Image dark = uniform_image(40, 3, .2f), bright = uniform_image(40, 3, .7f);
    const Image over = sign_heatmap(bright, dark), under = sign_heatmap(dark, bright), same = sign_heatmap(dark, dark);
    EXPECT_GT(over.pixel(5, 1)[0], over.pixel(5, 1)[2]);
    EXPECT_LT(under.pixel(5, 1)[0], under.pixel(5, 1)[2]);
    EXPECT_EQ(same.pixel(5, 1)[1], 0.f);
    EXPECT_THROW((void)sign_heatmap(dark, Image(4, 4)), Error);
}

}  // namespace image_metrics_test
}  // namespace subvol
