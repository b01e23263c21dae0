// SPDX-License-Identifier: Apache-2.0
#include "subvol/ssim.h"

#include "image_difference.h"
#include "separable.h"

namespace subvol {

using namespace detail;

using detail::Band;
using detail::Plane;
using detail::Taps;

namespace {

constexpr int kRadius = 5;
constexpr double kSigma = 1.5;
constexpr double kC1 = .01 * .01, kC2 = .03 * .03;

Plane channel_rows(const Image& image, const Band& band, std::size_t channel) {
    Plane plane(image.width, band.rows());
    for (int row = 0; row < plane.height; ++row) {
        const int y = band.picture_row(row, image.height);
        for (int x = 0; x < image.width; ++x) plane.row(row)[x] = static_cast<double>(image.pixel(x, y)[channel]);
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

PixelMask whole_windows(int width, int height) {
    if (width <= 2 * kRadius || height <= 2 * kRadius) return {};
    PixelMask mask;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const bool inside = x >= kRadius && y >= kRadius && x < width - kRadius && y < height - kRadius;
            mask.push_back(inside ? 1 : 0);
        }
    }
    return mask;
}

}  // namespace

SsimResult ssim(const Image& a, const Image& b) {
    check_finite(a, b);
    SsimResult result{0, {a.width, a.height, std::vector<float>(a.rgba.size() / 4)}};
    const Taps window = detail::gaussian_taps(kSigma, kRadius);
    detail::for_each_band(a.height, kRadius, [&](const Band& band) {
        const auto width = static_cast<std::size_t>(a.width);
        std::vector<double> sums(width * static_cast<std::size_t>(band.end - band.begin));
        for (std::size_t c = 0; c < 3; ++c) add_similarity(channel_rows(a, band, c), channel_rows(b, band, c), window, sums);
        float* out = result.map.values.data() + static_cast<std::size_t>(band.begin) * width;
        for (std::size_t i = 0; i < sums.size(); ++i) out[i] = static_cast<float>(sums[i] / 3);
    });
    result.mean = mean_of(result.map, whole_windows(a.width, a.height));
    return result;
}

}  // namespace subvol
