// SPDX-License-Identifier: Apache-2.0
#include "subvol/ssim.h"

#include <array>
#include <span>

#include "image_difference.h"
#include "separable.h"

namespace subvol {

using namespace detail;

using detail::Band;
using detail::Plane;
using detail::Taps;

namespace {

constexpr std::size_t kRadius = 5;
constexpr double kSigma = 1.5;
constexpr double kC1 = .01 * .01, kC2 = .03 * .03;

/// The weights of red, green and blue in a channel.
using Channel = std::array<double, 3>;

constexpr std::array<Channel, 3> kColors{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr std::array<Channel, 1> kLuminance{{{.2125, .7154, .0721}}};  // of Rec. 709, as scikit-image rounds them

Plane channel_rows(const Image& image, const Band& band, const Channel& weights) {
    Plane plane(image.width, band.rows());
    for (std::size_t row = 0; row < plane.height; ++row) {
        const std::size_t y = band.picture_row(row);
        for (std::size_t x = 0; x < plane.width; ++x) {
            const auto pixel = image.pixel(x, y);
            double value = 0;
            for (std::size_t c = 0; c < 3; ++c) value += weights[c] * double{pixel[c]};
            plane.at(x, row) = value;
        }
    }
    return plane;
}

Plane product(Plane a, const Plane& b) {
    for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] *= b.values[i];
    return a;
}

// Adds one channel's similarity at each pixel of the band.
void add_similarity(const Plane& a, const Plane& b, const Taps& window, std::vector<double>& sums) {
    const auto mean = [&](const Plane& plane) { return detail::convolved(plane, window, window, kRadius); };
    const Plane mean_a = mean(a), mean_b = mean(b), aa = mean(product(a, a)), bb = mean(product(b, b)),
                ab = mean(product(a, b));
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double ma = mean_a.values[i], mb = mean_b.values[i];
        const double variances = (aa.values[i] - ma * ma) + (bb.values[i] - mb * mb);
        const double covariance = ab.values[i] - ma * mb;
        sums[i] += (2 * ma * mb + kC1) * (2 * covariance + kC2) / ((ma * ma + mb * mb + kC1) * (variances + kC2));
    }
}

PixelMask whole_windows(std::size_t width, std::size_t height) {
    if (width <= 2 * kRadius || height <= 2 * kRadius) return {};
    Raster<std::uint8_t> mask(width, height);
    for (std::size_t y = kRadius; y < height - kRadius; ++y) {
        for (std::size_t x = kRadius; x < width - kRadius; ++x) mask.at(x, y) = 1;
    }
    return mask.values;
}

SsimResult similarity(const Image& a, const Image& b, std::span<const Channel> channels) {
    check_finite(a, b);
    SsimResult result{0, MetricMap(a.width, a.height)};
    const Taps window = detail::gaussian_taps(kSigma, kRadius);
    detail::for_each_band(result.map.height, kRadius, [&](const Band& band) {
        std::vector<double> sums(pixel_count(result.map.width, band.end - band.begin));
        for (const Channel& channel : channels)
            add_similarity(channel_rows(a, band, channel), channel_rows(b, band, channel), window, sums);
        float* out = result.map.row(band.begin).data();
        const auto count = static_cast<double>(channels.size());
        for (std::size_t i = 0; i < sums.size(); ++i) out[i] = static_cast<float>(sums[i] / count);
    });
    result.mean = mean_of(result.map, whole_windows(result.map.width, result.map.height));
    return result;
}

}  // namespace

SsimResult ssim(const Image& a, const Image& b) {
    return similarity(a, b, kColors);
}

SsimResult luminance_ssim(const Image& a, const Image& b) {
    return similarity(a, b, kLuminance);
}

}  // namespace subvol
