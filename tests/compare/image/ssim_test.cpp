// SPDX-License-Identifier: Apache-2.0
#include "subvol/ssim.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "random_image.h"
#include "subvol/error.h"

namespace subvol {
namespace ssim_test {

constexpr double kFloat = 1e-6;  // the map has floats in [-1,1]

/// One window of one channel, directly from the definition.
double similarity(const Image& a, const Image& b, int x, int y, std::size_t channel) {
    double weights = 0, mean_a = 0, mean_b = 0, var_a = 0, var_b = 0, cov = 0;
    const auto each = [&](const auto& visit) {
        for (int j = -5; j <= 5; ++j) {
            for (int i = -5; i <= 5; ++i) {
                const int u = std::clamp(x + i, 0, a.width - 1), v = std::clamp(y + j, 0, a.height - 1);
                visit(std::exp(-(i * i + j * j) / (2 * 1.5 * 1.5)), static_cast<double>(a.pixel(u, v)[channel]),
                      static_cast<double>(b.pixel(u, v)[channel]));
            }
        }
    };
    each([&](double w, double, double) { weights += w; });
    each([&](double w, double p, double q) {
        mean_a += w / weights * p;
        mean_b += w / weights * q;
    });
    each([&](double w, double p, double q) {
        var_a += w / weights * (p - mean_a) * (p - mean_a);
        var_b += w / weights * (q - mean_b) * (q - mean_b);
        cov += w / weights * (p - mean_a) * (q - mean_b);
    });
    return (2 * mean_a * mean_b + 1e-4) * (2 * cov + 9e-4) /
           ((mean_a * mean_a + mean_b * mean_b + 1e-4) * (var_a + var_b + 9e-4));
}

double similarity(const Image& a, const Image& b, int x, int y) {
    return (similarity(a, b, x, y, 0) + similarity(a, b, x, y, 1) + similarity(a, b, x, y, 2)) / 3;
}

TEST(Ssim, AsTheDefinition) {
    const Image a = random_image(19, 70, 1), b = random_image(19, 70, 2);  // more rows than a band has
    const SsimResult result = ssim(a, b);
    double sum = 0;
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            const double expected = similarity(a, b, x, y);
            ASSERT_NEAR(static_cast<double>(result.map.values[static_cast<std::size_t>(y * a.width + x)]), expected, kFloat);
            if (x >= 5 && y >= 5 && x < a.width - 5 && y < a.height - 5) sum += expected;
        }
    }
    EXPECT_NEAR(result.mean, sum / (9 * 60), kFloat);
}

TEST(Ssim, OfLuminanceIsThatOfTheGreyPictures) {
    const Image a = random_image(23, 17, 8), b = random_image(23, 17, 9);
    const auto grey = [](Image image) {
        for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
            const float y = .2125f * image.rgba[i] + .7154f * image.rgba[i + 1] + .0721f * image.rgba[i + 2];
            image.rgba[i] = image.rgba[i + 1] = image.rgba[i + 2] = y;
        }
        return image;
    };
    EXPECT_NEAR(luminance_ssim(a, b).mean, ssim(grey(a), grey(b)).mean, kFloat);
    EXPECT_GT(std::abs(luminance_ssim(a, b).mean - ssim(a, b).mean), 1e-4);  // two metrics, so two names
}

TEST(Ssim, EqualPicturesAreOne) {
    const Image a = random_image(30, 20, 3);
    const SsimResult result = ssim(a, a);
    EXPECT_EQ(result.mean, 1);
    EXPECT_EQ(*std::min_element(result.map.values.begin(), result.map.values.end()), 1.0f);
}

TEST(Ssim, PlainPicturesByHand) {
    // Without variance the second factor is 1: (2·.2·.6 + 1e-4) / (.04 + .36 + 1e-4).
    const double expected = (2 * .2 * .6 + 1e-4) / (.2 * .2 + .6 * .6 + 1e-4);
    const SsimResult result = ssim(plain_image(16, 16, .2f, .2f, .2f), plain_image(16, 16, .6f, .6f, .6f));
    EXPECT_NEAR(result.mean, expected, kFloat);
    // In one channel only: a third of the loss.
    EXPECT_NEAR(ssim(plain_image(16, 16, .2f, .2f, .2f), plain_image(16, 16, .2f, .2f, .6f)).mean, (2 + expected) / 3, kFloat);
}

TEST(Ssim, SymmetricAndBelowOne) {
    const Image a = random_image(25, 25, 4), b = random_image(25, 25, 5);
    EXPECT_EQ(ssim(a, b).map.values, ssim(b, a).map.values);
    EXPECT_LT(ssim(a, b).mean, .2);  // independent noise has no structure in common
    Image turned = a;
    for (std::size_t i = 0; i < turned.rgba.size(); ++i) turned.rgba[i] = i % 4 == 3 ? 1 : 1 - turned.rgba[i];
    EXPECT_LT(ssim(a, turned).mean, 0);  // the opposite structure
}

TEST(Ssim, SmallPicturesCountWhole) {
    const Image a = random_image(4, 3, 6), b = random_image(4, 3, 7);
    double sum = 0;
    for (int p = 0; p < 12; ++p) sum += similarity(a, b, p % 4, p / 4);
    EXPECT_NEAR(ssim(a, b).mean, sum / 12, kFloat);
}

TEST(Ssim, RefusesWhatHasNoAnswer) {
    Image bad(12, 12);
    bad.pixel(2, 1)[3] = std::numeric_limits<float>::infinity();
    EXPECT_THROW((void)ssim(Image(12, 12), bad), Error);
    EXPECT_THROW((void)ssim(Image(12, 12), Image(12, 13)), Error);
    EXPECT_THROW((void)ssim(Image(), Image()), Error);
}

}  // namespace ssim_test
}  // namespace subvol
