// SPDX-License-Identifier: Apache-2.0
#include "subvol/picture_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "subvol/image_regions.h"

namespace subvol {
namespace picture_metrics_test {

/// A grey square in front of nothing.
Image square(float grey) {
    Image image(24, 20);
    for (int y = 6; y < 16; ++y) {
        for (int x = 6; x < 18; ++x) std::ranges::fill(image.pixel(x, y), x == y ? 0.9F * grey : grey);
    }
    for (int y = 6; y < 16; ++y) {
        for (int x = 6; x < 18; ++x) image.pixel(x, y)[3] = 1;
    }
    return image;
}

TEST(PictureMetrics, EachIsItsCallOfTheTwoPictures) {
    const Image a = square(0.5F), b = square(0.6F);
    const auto measured = measure_pictures(a, b, "rmse,psnr,ssim,ssim_linear,flip,flip_hdr,optical_depth");
    EXPECT_EQ(measured.at("rmse"), compare_images(a, b).rmse);
    EXPECT_EQ(measured.at("psnr"), compare_images(a, b).psnr);
    EXPECT_EQ(measured.at("ssim"), luminance_ssim(srgb8_image(a), srgb8_image(b)).mean);  // as [ssim2004] has it
    EXPECT_EQ(measured.at("ssim_linear"), ssim(a, b).mean);
    EXPECT_EQ(measured.at("flip"), flip(a, b).mean);
    EXPECT_EQ(measured.at("flip_hdr"), hdr_flip(a, b).mean);
    EXPECT_EQ(measured.at("optical_depth"), optical_depth_error(a, b));
    EXPECT_EQ(measured.size(), 7U);
}

TEST(PictureMetrics, OfARegionCountItsPixelsAlone) {
    const Image a = square(0.5F), b = square(0.6F);
    const ImageRegions regions = silhouette_regions(b);
    const auto measured = measure_pictures(a, b, "rmse_interior,flip_edge");
    EXPECT_EQ(measured.at("rmse_interior"), compare_images(a, b, regions.interior).rmse);
    EXPECT_EQ(measured.at("flip_edge"), mean_of(flip(a, b).map, regions.edge));
    EXPECT_TRUE(measure_pictures(Image(8, 8), Image(8, 8), "psnr_interior").empty());  // nothing is in front
}

TEST(PictureMetrics, AreFoundByTheirFigures) {
    for (const char* figure : {"psnr", "srgb8.psnr", "edge.psnr", "psnr_edge"}) {
        ASSERT_NE(find_metric(figure), nullptr) << figure;
        EXPECT_EQ(find_metric(figure)->unit, "dB") << figure;
        EXPECT_TRUE(find_metric(figure)->more_is_better) << figure;
    }
    EXPECT_FALSE(find_metric("flip_hdr")->more_is_better);
    EXPECT_EQ(find_metric("seconds"), nullptr);
    const std::vector<std::string> names = study_metrics();
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
    for (const std::string& name : names) EXPECT_NE(find_metric(name), nullptr) << name;
    for (const PictureMetric& metric : picture_metrics()) {
        EXPECT_FALSE(metric.quantity.empty()) << metric.name;
        EXPECT_FALSE(metric.formula.empty()) << metric.name;
    }
}

TEST(PictureMetrics, SayOfEqualPicturesThatTheyAreTheBest) {
    const Image a = square(0.5F), other = square(0.6F);
    const PicturePair same(a, a), apart(a, other);
    for (const PictureMetric& metric : picture_metrics()) {
        const double best = metric.of(same, {}), less = metric.of(apart, {});
        if (metric.name == "optical_depth_error") continue;  // of opaque pictures it is 0
        EXPECT_TRUE(metric.more_is_better ? best > less : best < less) << metric.name;
    }
}

}  // namespace picture_metrics_test
}  // namespace subvol
