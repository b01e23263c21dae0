// SPDX-License-Identifier: Apache-2.0
#include "subvol/image_regions.h"

#include <algorithm>
#include <cmath>

#include "image_difference.h"
#include "subvol/error.h"
#include "subvol/srgb.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kOneStep = 1.0 / 255;

double encoded(double linear) {
    return srgb_from_linear(std::clamp(linear, 0.0, 1.0));
}

Raster<std::uint8_t> coverage(const Image& image, const Vec3& background) {
    Raster<std::uint8_t> mask(image.width, image.height);
    bool opaque = true;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) opaque = opaque && image.rgba[i] >= 1.0f;
    for (std::size_t p = 0; p < mask.values.size(); ++p) {
        const float* rgba = image.rgba.data() + 4 * p;
        bool covered = !opaque && rgba[3] > 0;
        for (int c = 0; opaque && c < 3; ++c) {
            const double difference = encoded(double{rgba[c]}) - encoded(background[c]);
            covered = covered || std::abs(difference) > kOneStep;
        }
        mask.values[p] = covered ? 1 : 0;
    }
    return mask;
}

/// Dilates a line of `count` numbers that lie `stride` apart by `reach`.
void widen_line(std::uint8_t* line, std::size_t count, std::size_t stride, std::size_t reach) {
    std::vector<std::uint8_t> before(count);
    for (std::size_t i = 0; i < count; ++i) before[i] = line[i * stride];
    std::size_t next = 0;  // all before it are set
    for (std::size_t i = 0; i < count; ++i) {
        if (before[i] == 0) continue;
        next = std::max(next, i - std::min(i, reach));
        for (; next < std::min(count, i + reach + 1); ++next) line[next * stride] = 1;
    }
}

Raster<std::uint8_t> widened(Raster<std::uint8_t> mask, std::size_t reach) {
    for (std::size_t y = 0; y < mask.height; ++y) widen_line(mask.row(y).data(), mask.width, 1, reach);
    for (std::size_t x = 0; x < mask.width; ++x) widen_line(&mask.at(x, 0), mask.height, mask.width, reach);
    return mask;
}

Raster<std::uint8_t> inverse(Raster<std::uint8_t> mask) {
    for (std::uint8_t& pixel : mask.values) pixel = pixel == 0 ? 1 : 0;
    return mask;
}

}  // namespace

ImageRegions silhouette_regions(const Image& reference, int band_px, const Vec3& background) {
    check_comparable(reference, reference);
    if (band_px < 1)
        throw Error(ErrorCode::InvalidInput, "a band of " + std::to_string(band_px) + " pixels is too narrow", {}, "1 or more");
    const Raster<std::uint8_t> covered = coverage(reference, background);
    const auto reach = static_cast<std::size_t>(band_px);
    // The interior: covered pixels that are farther than the band from all uncovered ones.
    ImageRegions regions{inverse(widened(inverse(covered), reach)).values, widened(covered, reach).values};
    for (std::size_t i = 0; i < regions.edge.size(); ++i) {
        if (regions.interior[i] != 0) regions.edge[i] = 0;
    }
    return regions;
}

OpticalDepth optical_depth(const Image& image) {
    check_finite(image, image);
    constexpr double kLeast = 0x1p-24;  // half the step of floats below 1
    constexpr double kFew = 1e-4;
    OpticalDepth depth;
    for (int y = 0; y < image.height; ++y) {
        double sum = 0;
        for (int x = 0; x < image.width; ++x) {
            const double through = 1 - double{image.pixel(x, y)[3]};
            if (through < kFew) ++depth.saturated;
            sum -= std::log(std::max(through, kLeast));
        }
        depth.sum += sum;
    }
    return depth;
}

double optical_depth_error(const Image& a, const Image& reference) {
    check_comparable(a, reference);
    const double difference = std::abs(optical_depth(a).sum - optical_depth(reference).sum);
    return difference == 0 ? 0 : difference / std::abs(optical_depth(reference).sum);
}

}  // namespace subvol
