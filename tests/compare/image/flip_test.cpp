// SPDX-License-Identifier: Apache-2.0
#include "subvol/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "random_image.h"
#include "subvol/error.h"
#include "subvol/vec.h"

namespace subvol {
namespace flip_test {

constexpr double kFloat = 1e-6;  // maps are floats in [0,1], and the colour exponents at most double an error

// A second implementation of FLIP, directly from the papers: in double, with full square filters, one pixel at a time.
namespace naive {

using Pixels = std::vector<Vec3>;
const double kPi = std::acos(-1.0);

/// Computed from the chromaticities of sRGB's primaries and its white.
Mat3 primaries() {
    const auto xyz = [](double x, double y) { return Vec3(x / y, 1, (1 - x - y) / y); };
    const Mat3 unscaled(xyz(.64, .33), xyz(.30, .60), xyz(.15, .06));
    const Vec3 scale = glm::inverse(unscaled) * xyz(.31271, .32902);
    return {unscaled[0] * scale.x, unscaled[1] * scale.y, unscaled[2] * scale.z};
}
Vec3 xyz_of(const Vec3& rgb) {
    return primaries() * rgb / (primaries() * Vec3(1.0));
}
Vec3 opponent_of(const Vec3& rgb) {
    const Vec3 v = xyz_of(rgb);
    return {116 * v.y - 16, 500 * (v.x - v.y), 200 * (v.y - v.z)};
}
Vec3 rgb_of(const Vec3& opponent) {
    const double y = (opponent.x + 16) / 116;
    const Vec3 v{opponent.y / 500 + y, y, y - opponent.z / 200};
    return glm::inverse(primaries()) * (v * (primaries() * Vec3(1.0)));
}
double root(double t) {
    return t > 216. / 24389 ? std::pow(t, 1. / 3) : 841. / 108 * t + 4. / 29;
}
Vec3 hunt_lab(const Vec3& rgb) {
    const Vec3 v = xyz_of(rgb);
    const double l = 116 * root(v.y) - 16;
    return {l, 5 * l * (root(v.x) - root(v.y)), 2 * l * (root(v.y) - root(v.z))};
}
double color_distance(const Vec3& a, const Vec3& b) {
    const Vec3 p = hunt_lab(a), q = hunt_lab(b);
    return std::pow(std::abs(p.x - q.x) + std::sqrt((p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z)), .7);
}

/// Sums a filter's weights times the picture over a square; the picture's last pixels repeat beyond its border.
template <class Weight>
Vec3 filtered(const Pixels& pixels, int width, int height, int x, int y, int reach, const Weight& weight) {
    Vec3 sum(0.0);
    for (int j = -reach; j <= reach; ++j) {
        for (int i = -reach; i <= reach; ++i) {
            const int u = std::clamp(x + i, 0, width - 1), v = std::clamp(y + j, 0, height - 1);
            sum += weight(i, j) * pixels[static_cast<std::size_t>(v * width + u)];
        }
    }
    return sum;
}

struct Picture {
    Pixels opponent;
    int width, height;
    double ppd;

    [[nodiscard]] Vec3 color(int x, int y) const {
        const int reach = static_cast<int>(std::ceil(3 * std::sqrt(.04 / (2 * kPi * kPi)) * ppd));
        const auto weight = [&](int i, int j) {
            const double d2 = (i * i + j * j) / (ppd * ppd);
            const auto term = [&](double a, double b) { return a * std::sqrt(kPi / b) * std::exp(-kPi * kPi * d2 / b); };
            return Vec3(term(1, .0047), term(1, .0053), term(34.1, .04) + term(13.5, .025));
        };
        Vec3 total(0.0);
        for (int j = -reach; j <= reach; ++j) {
            for (int i = -reach; i <= reach; ++i) total += weight(i, j);
        }
        return glm::clamp(rgb_of(filtered(opponent, width, height, x, y, reach, weight) / total), 0.0, 1.0);
    }

    [[nodiscard]] double feature(int x, int y, bool point) const {
        const double sigma = .5 * .082 * ppd;
        const int reach = static_cast<int>(std::ceil(3 * sigma));
        const auto shape = [&](int i, int j) {
            const double g = std::exp(-(i * i + j * j) / (2 * sigma * sigma));
            return point ? (i * i / (sigma * sigma) - 1) * g : -i * g;
        };
        double above = 0, below = 0;
        for (int j = -reach; j <= reach; ++j) {
            for (int i = -reach; i <= reach; ++i) (shape(i, j) > 0 ? above : below) += std::abs(shape(i, j));
        }
        const auto weight = [&](int i, int j) { return shape(i, j) / (shape(i, j) > 0 ? above : below); };
        Pixels luminance;
        for (const Vec3& c : opponent) luminance.emplace_back((c.x + 16) / 116);
        const double along_x = filtered(luminance, width, height, x, y, reach, weight).x;
        const auto turned = [&](int i, int j) { return weight(j, i); };
        return std::hypot(along_x, filtered(luminance, width, height, x, y, reach, turned).x);
    }
};

Picture picture_of(const Image& image, double ppd) {
    Pixels opponent;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const Vec3 rgb{image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]};
        opponent.push_back(opponent_of(glm::clamp(rgb, 0.0, 1.0)));
    }
    return {opponent, image.width, image.height, ppd};
}

double flip_at(const Picture& a, const Picture& b, int x, int y) {
    const double most = color_distance({0, 1, 0}, {0, 0, 1}), bend = .4 * most;
    const double distance = color_distance(a.color(x, y), b.color(x, y));
    const double color = distance < bend ? .95 * distance / bend : .95 + .05 * (distance - bend) / (most - bend);
    const double edges = std::abs(a.feature(x, y, false) - b.feature(x, y, false));
    const double points = std::abs(a.feature(x, y, true) - b.feature(x, y, true));
    return std::pow(color, 1 - std::sqrt(std::max(edges, points) / std::sqrt(2.0)));
}

}  // namespace naive

void expect_as_the_formula(const Image& a, const Image& b, double ppd) {
    const FlipResult result = flip(a, b, ppd);
    const auto one = naive::picture_of(a, ppd), other = naive::picture_of(b, ppd);
    double sum = 0;
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            const double expected = naive::flip_at(one, other, x, y);
            sum += expected;
            const auto measured = static_cast<double>(result.map.values[static_cast<std::size_t>(y * a.width + x)]);
            ASSERT_NEAR(measured, expected, kFloat) << x << ' ' << y;
        }
    }
    EXPECT_NEAR(result.mean, sum / (a.width * a.height), kFloat);
}

double flip_of_colors(const Vec3& a, const Vec3& b) {
    const auto plain = [](const Vec3& c) {
        return plain_image(9, 7, static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z));
    };
    return flip(plain(a), plain(b)).mean;
}

TEST(Flip, GreenAgainstBlueIsTheMost) {
    EXPECT_NEAR(flip_of_colors({0, 1, 0}, {0, 0, 1}), 1, kFloat);
    EXPECT_NEAR(flip_of_colors({0, 0, 1}, {0, 1, 0}), 1, kFloat);
}

TEST(Flip, PlainColorsByHand) {
    // Black and white differ by ΔL = 100 only: 100^.7 = 25.1189. Green and blue have the largest difference, 203.302 (HyAB
    // after Hunt), 41.2760 after the exponent. Beyond the bend at .4 of it: .95 + .05 (25.1189 − 16.5104) / (41.2760
    // − 16.5104).
    EXPECT_NEAR(flip_of_colors({0, 0, 0}, {1, 1, 1}), .96738, 1e-5);
    // L of a grey with Y = .18 is 49.496: |100 − 49.496|^.7 = 15.5714 lies below the bend: .95 · 15.5714 / 16.5104.
    EXPECT_NEAR(flip_of_colors({.18, .18, .18}, {1, 1, 1}), .89597, 1e-5);
    EXPECT_EQ(flip_of_colors({.3, .2, .7}, {.3, .2, .7}), 0);
}

TEST(Flip, AsTheFormulaForNoise) {
    expect_as_the_formula(random_image(24, 17, 1), random_image(24, 17, 2), kFlipPixelsPerDegree);
    expect_as_the_formula(random_image(13, 21, 3), random_image(13, 21, 4), 20);
}

TEST(Flip, AsTheFormulaForEdgesAndPoints) {
    Image a = plain_image(31, 26, .2f, .3f, .25f);
    for (int y = 0; y < a.height; ++y) {
        for (int x = 15; x < a.width; ++x) a.pixel(x, y)[1] = .8f;
    }
    Image b = a;
    b.pixel(4, 4)[0] = 1;
    b.pixel(30, 25)[2] = 0;
    for (int y = 0; y < a.height; ++y) b.pixel(15, y)[1] = .3f;  // the edge one pixel further right
    expect_as_the_formula(a, b, kFlipPixelsPerDegree);
}

TEST(Flip, BandsOfRowsDoNotShow) {
    const Image a = random_image(7, 140, 5), b = random_image(7, 140, 6);
    const FlipResult result = flip(a, b, 20);
    const auto one = naive::picture_of(a, 20), other = naive::picture_of(b, 20);
    for (const int y : {0, 62, 63, 64, 65, 127, 128, 139}) {
        EXPECT_NEAR(static_cast<double>(result.map.values[static_cast<std::size_t>(y * 7 + 3)]),
                    naive::flip_at(one, other, 3, y), kFloat);
    }
}

TEST(Flip, BothPicturesCountAlike) {
    const Image a = random_image(40, 30, 7), b = random_image(40, 30, 8);
    EXPECT_EQ(flip(a, b).map.values, flip(b, a).map.values);
}

TEST(Flip, BeyondWhiteIsWhite) {
    EXPECT_EQ(flip(plain_image(8, 8, 5, 1, 2), plain_image(8, 8, 1, 1, 1)).mean, 0);
}

TEST(Flip, RefusesWhatHasNoAnswer) {
    const Image a(4, 4);
    Image bad = a;
    bad.pixel(2, 1)[0] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW((void)flip(a, bad), Error);
    EXPECT_THROW((void)flip(a, Image(4, 5)), Error);
    EXPECT_THROW((void)flip(Image(), Image()), Error);
    EXPECT_THROW((void)flip(a, a, 0), Error);
    EXPECT_THROW((void)flip(a, a, std::nan("")), Error);
}

// Narkowicz' curve with its exposure of .6.
double aces(double light) {
    const double x = .6 * light;
    return std::clamp(x * (2.51 * x + .03) / (x * (2.43 * x + .59) + .14), 0.0, 1.0);
}

TEST(HdrFlip, ExposuresBringMaximumAndMedianToTheScreen) {
    Image reference = plain_image(10, 10, .01f, .01f, .01f);
    for (int x = 0; x < 10; ++x) {
        for (std::size_t c = 0; c < 3; ++c) reference.pixel(x, 4)[c] = 8;
    }
    const HdrFlipResult result = hdr_flip(reference, reference);
    EXPECT_NEAR(aces(8 * std::exp2(result.start)), .85, 1e-6);
    EXPECT_NEAR(aces(.01 * std::exp2(result.stop)), .85, 1e-6);  // .01 is a float here
    EXPECT_EQ(result.exposures, 10);                             // log2 of 800 is 9.6
    EXPECT_EQ(result.mean, 0);
}

TEST(HdrFlip, IsTheLargestOverTheExposures) {
    const Image a = random_image(16, 12, 9, 20), b = random_image(16, 12, 10, 20);
    const HdrFlipResult result = hdr_flip(a, b, {.start = -3, .stop = 1.5});
    ASSERT_EQ(result.exposures, 5);
    std::vector<double> expected(16 * 12, 0.0);
    for (int k = 0; k < 5; ++k) {
        const auto screen = [&](const Image& image) {
            Image mapped = image;
            for (float& v : mapped.rgba) v = static_cast<float>(aces(std::exp2(-3 + 4.5 * k / 4) * static_cast<double>(v)));
            return naive::picture_of(mapped, kFlipPixelsPerDegree);
        };
        const auto one = screen(a), other = screen(b);
        for (int p = 0; p < 16 * 12; ++p) {
            double& most = expected[static_cast<std::size_t>(p)];
            most = std::max(most, naive::flip_at(one, other, p % 16, p / 16));
        }
    }
    for (std::size_t p = 0; p < expected.size(); ++p) {
        ASSERT_NEAR(static_cast<double>(result.map.values[p]), expected[p], kFloat);
    }
}

TEST(HdrFlip, ABlackBackgroundDoesNotMakeTheMedian) {
    Image reference(20, 20);  // black
    reference.pixel(3, 3)[1] = 1;
    reference.pixel(4, 3)[1] = .25f;
    reference.pixel(5, 3)[1] = .25f;
    const HdrFlipResult result = hdr_flip(Image(20, 20), reference);
    EXPECT_NEAR(result.stop - result.start, 2, 1e-9);
    EXPECT_GT(result.mean, 0);
    EXPECT_EQ(hdr_flip(reference, Image(20, 20)).stop, 0);  // a black reference determines no exposure
}

TEST(HdrFlip, RefusesExposuresThatAreNone) {
    const Image a = plain_image(4, 4, 1, 1, 1);
    EXPECT_THROW((void)hdr_flip(a, a, {.start = 2, .stop = 1}), Error);
    EXPECT_THROW((void)hdr_flip(a, a, {.start = 0, .stop = 1000}), Error);
    EXPECT_THROW((void)hdr_flip(a, a, {.start = std::nan(""), .stop = 1}), Error);
}

}  // namespace flip_test
}  // namespace subvol
