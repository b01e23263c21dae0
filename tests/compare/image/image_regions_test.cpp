// SPDX-License-Identifier: Apache-2.0
#include "subvol/image_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "random_image.h"
#include "subvol/error.h"

namespace subvol {
namespace image_regions_test {

bool in_disc(int x, int y) {
    return (x - 17) * (x - 17) + (y - 14) * (y - 14) <= 100;
}

Image disc(int width, int height) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (in_disc(x, y)) std::ranges::fill(image.pixel(x, y), .5f);
        }
    }
    return image;
}

/// Whether some pixel of the picture within `reach` of (x, y), corners included, is in the disc (or, if not covered, outside).
bool near(bool covered, int x, int y, int reach, const Image& image) {
    for (int v = std::max(0, y - reach); v <= std::min(image.height - 1, y + reach); ++v) {
        for (int u = std::max(0, x - reach); u <= std::min(image.width - 1, x + reach); ++u) {
            if (in_disc(u, v) == covered) return true;
        }
    }
    return false;
}

void expect_regions_of_the_disc(const ImageRegions& regions, const Image& image, int reach) {
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto p = static_cast<std::size_t>(y * image.width + x);
            ASSERT_EQ(regions.interior[p] != 0, !near(false, x, y, reach, image)) << x << ' ' << y;
            ASSERT_EQ(regions.edge[p] != 0, near(true, x, y, reach, image) && near(false, x, y, reach, image)) << x << ' ' << y;
        }
    }
}

TEST(ImageRegions, BandAlongTheSilhouette) {
    const Image image = disc(40, 33);
    for (const int reach : {1, 2, 5}) expect_regions_of_the_disc(silhouette_regions(image, reach), image, reach);
}

TEST(ImageRegions, TheBorderOfThePictureIsNoSilhouette) {
    const Image image = disc(20, 15);  // cuts the disc
    expect_regions_of_the_disc(silhouette_regions(image, 3), image, 3);
    const ImageRegions whole = silhouette_regions(plain_image(6, 5, 1, 1, 1), 2);
    EXPECT_EQ(std::count(whole.interior.begin(), whole.interior.end(), 1), 30);
    EXPECT_EQ(std::count(whole.edge.begin(), whole.edge.end(), 1), 0);
}

TEST(ImageRegions, AnOpaquePictureIsTakenByItsBackground) {
    const Vec3 background(.2, .3, .4);
    Image image = disc(40, 33);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        // As in an 8-bit file: not exactly the background.
        for (int c = 0; c < 3; ++c)
            image.rgba[i + static_cast<std::size_t>(c)] += image.rgba[i + 3] > 0 ? 0 : static_cast<float>(background[c] + .001);
        image.rgba[i + 3] = 1;
    }
    expect_regions_of_the_disc(silhouette_regions(image, 2, background), image, 2);
}

TEST(ImageRegions, ErrorsShowWhereTheyAre) {
    const Image a = disc(40, 33);
    Image b = a;
    b.pixel(17, 14)[0] += .25f;  // the disc's middle
    b.pixel(7, 14)[1] += .5f;    // its leftmost pixel
    const ImageRegions regions = silhouette_regions(a, 1);
    EXPECT_EQ(compare_images(a, b, regions.interior).max, .25);
    EXPECT_EQ(compare_images(a, b, regions.edge).max, .5);
    EXPECT_EQ(compare_images(a, b).max, .5);
    const auto count = static_cast<double>(std::count(regions.edge.begin(), regions.edge.end(), 1));
    EXPECT_DOUBLE_EQ(compare_images(a, b, regions.edge).mse, .25 / (3 * count));
    EXPECT_DOUBLE_EQ(mean_of(difference_map(a, b), regions.edge), .5 / count);
    EXPECT_THROW((void)compare_images(a, b, PixelMask(40 * 33)), Error);  // no pixel counts
    EXPECT_THROW((void)compare_images(a, b, PixelMask(7, 1)), Error);
    EXPECT_THROW((void)silhouette_regions(a, 0), Error);
}

TEST(Srgb8Image, IsWhatAPngHolds) {
    Image image = plain_image(2, 1, 0, .5f, 1);
    image.pixel(1, 0)[3] = .5f;  // half covered, over the background
    const Image encoded = srgb8_image(image, Vec3(.25));
    // sRGB of .5 is .735357 = 187.5 / 255; of .125 = half of .25 it is .388573 = 99.1 / 255.
    EXPECT_EQ(encoded.pixel(0, 0)[0], 0);
    EXPECT_EQ(encoded.pixel(0, 0)[1], 188 / 255.0f);
    EXPECT_EQ(encoded.pixel(0, 0)[2], 1);
    EXPECT_EQ(encoded.pixel(1, 0)[0], 99 / 255.0f);
    EXPECT_EQ(encoded.pixel(1, 0)[3], 1);
}

TEST(Srgb8Image, DifferencesBelowAStepAreNone) {
    const Image a = plain_image(4, 4, .5f, .5f, .5f), b = plain_image(4, 4, .5002f, .5f, .5f);
    EXPECT_GT(compare_images(a, b).max, 0);
    EXPECT_EQ(compare_images(srgb8_image(a), srgb8_image(b)).max, 0);
    const Image c = plain_image(4, 4, .5f, .5f, .51f);  // 189.3 in 255 steps: one step up
    EXPECT_FLOAT_EQ(static_cast<float>(compare_images(srgb8_image(a), srgb8_image(c)).max), 1 / 255.0f);
}

TEST(NotFinite, PixelsAreCounted) {
    Image image(3, 3);
    EXPECT_EQ(count_not_finite(image), 0u);
    std::ranges::fill(image.pixel(1, 1), std::numeric_limits<float>::quiet_NaN());
    image.pixel(2, 0)[3] = std::numeric_limits<float>::infinity();
    EXPECT_EQ(count_not_finite(image), 2u);
}

TEST(OpticalDepth, OfAGaussianIsItsIntegral) {
    // Along each ray the density 2 exp(−r²/2σ²) has the depth 2 σ √2π exp(−b²/2σ²); all rays together, with pixels of side h,
    // 2 (2πσ²)^(3/2) / h². The sum over pixels of a Gaussian as wide as 10 of them is that to rounding.
    constexpr double kSigma = .1, kPixel = .01;
    Image image(161, 161);
    for (int y = 0; y < 161; ++y) {
        for (int x = 0; x < 161; ++x) {
            const double b2 = ((x - 80) * (x - 80) + (y - 80) * (y - 80)) * kPixel * kPixel;
            const double depth = 2 * kSigma * std::sqrt(2 * std::numbers::pi) * std::exp(-b2 / (2 * kSigma * kSigma));
            image.pixel(x, y)[3] = static_cast<float>(1 - std::exp(-depth));
        }
    }
    const double expected = 2 * std::pow(2 * std::numbers::pi * kSigma * kSigma, 1.5);
    const OpticalDepth depth = optical_depth(image);
    EXPECT_NEAR(depth.sum * kPixel * kPixel, expected, 1e-6 * expected);  // alpha is a float
    EXPECT_EQ(depth.saturated, 0u);
}

TEST(OpticalDepth, RelativeError) {
    Image a(4, 1), b(4, 1);
    for (int x = 0; x < 4; ++x) {
        a.pixel(x, 0)[3] = static_cast<float>(1 - std::exp(-1.1 * x));
        b.pixel(x, 0)[3] = static_cast<float>(1 - std::exp(-1.0 * x));
    }
    EXPECT_NEAR(optical_depth_error(a, b), .1, 1e-5);  // e³ · a float's rounding, twice
    EXPECT_EQ(optical_depth_error(b, b), 0);
    EXPECT_EQ(optical_depth_error(Image(4, 1), Image(4, 1)), 0);
    EXPECT_EQ(optical_depth_error(b, Image(4, 1)), std::numeric_limits<double>::infinity());
}

TEST(OpticalDepth, OpaquePixelsAreTold) {
    const OpticalDepth depth = optical_depth(plain_image(3, 2, 0, 0, 0));
    EXPECT_EQ(depth.saturated, 6u);
    EXPECT_NEAR(depth.sum, 6 * 24 * std::log(2), 1e-12);
}

}  // namespace image_regions_test
}  // namespace subvol
