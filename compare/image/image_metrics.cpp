// SPDX-License-Identifier: Apache-2.0
#include "subvol/image_metrics.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "image_difference.h"
#include "subvol/error.h"
#include "subvol/image_io.h"

namespace subvol {

using namespace detail;

namespace {

struct Sums {
    double squares = 0, absolutes = 0, largest = 0;
    std::size_t count = 0;

    void add(double difference) {
        squares += difference * difference;
        absolutes += std::abs(difference);
        largest = std::fmax(largest, std::abs(difference));
        ++count;
    }
    void add(const Sums& other) {
        squares += other.squares;
        absolutes += other.absolutes;
        largest = std::fmax(largest, other.largest);
        count += other.count;
    }
};

double difference(const Image& a, const Image& b, int x, int y, std::size_t channel) {
    return double{a.pixel(x, y)[channel]} - double{b.pixel(x, y)[channel]};
}

double pixel_difference(const Image& a, const Image& b, int x, int y) {
    double largest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double d = std::abs(difference(a, b, x, y, c));
        if (!(d <= largest)) largest = d;
        if (std::isnan(d)) break;
    }
    return largest;
}

std::string size_text(const Image& image) {
    return std::to_string(image.width) + " x " + std::to_string(image.height);
}

void check_mask(std::span<const std::uint8_t> mask, std::size_t pixels) {
    if (mask.empty() || mask.size() == pixels) return;
    throw Error(ErrorCode::InvalidInput,
                "the mask has " + std::to_string(mask.size()) + " pixels, the picture " + std::to_string(pixels));
}

[[noreturn]] void no_pixel_counts() {
    throw Error(ErrorCode::InvalidInput, "the region has no pixels");
}

}  // namespace

void detail::check_comparable(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height) {
        throw Error(ErrorCode::InvalidInput,
                    "images of " + size_text(a) + " and " + size_text(b) + " pixels cannot be compared");
    }
    if (a.width < 1 || a.height < 1) throw Error(ErrorCode::InvalidInput, "images without pixels cannot be compared");
}

void detail::check_finite(const Image& a, const Image& b) {
    check_comparable(a, b);
    const std::size_t bad_a = count_not_finite(a), bad_b = count_not_finite(b);
    if (bad_a + bad_b == 0) return;
    throw Error(ErrorCode::InvalidInput, std::to_string(bad_a) + " pixels of the one picture and " + std::to_string(bad_b) +
                                             " of the other are infinite or not a number");
}

ImageMetrics compare_images(const Image& a, const Image& b, std::span<const std::uint8_t> mask) {
    check_comparable(a, b);
    check_mask(mask, pixel_count(a.width, a.height));
    // First each row, then the rows: always in the same order, with summands of similar size.
    Sums total;
    for (int y = 0; y < a.height; ++y) {
        Sums row;
        for (int x = 0; x < a.width; ++x) {
            if (!mask.empty() && mask[pixel_index(a.width, x, y)] == 0) continue;
            for (std::size_t c = 0; c < 3; ++c) row.add(difference(a, b, x, y, c));
        }
        total.add(row);
    }
    if (total.count == 0) no_pixel_counts();
    const double mse = total.squares / static_cast<double>(total.count);
    return {.mse = mse,
            .rmse = std::sqrt(mse),
            .mae = total.absolutes / static_cast<double>(total.count),
            .max = std::isnan(mse) ? mse : total.largest,
            .psnr = -10 * std::log10(mse)};
}

Image srgb8_image(const Image& image, const Vec3& background) {
    const std::vector<std::uint8_t> bytes = srgb_bytes(image, background);
    Image encoded(image.width, image.height);
    for (std::size_t i = 0; i < encoded.rgba.size(); ++i) {
        encoded.rgba[i] = i % 4 == 3 ? 1.0f : static_cast<float>(bytes[i / 4 * 3 + i % 4]) / 255.0f;
    }
    return encoded;
}

std::size_t count_not_finite(const Image& image) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const bool finite = std::all_of(&image.rgba[i], &image.rgba[i] + 4, [](float v) { return std::isfinite(v); });
        if (!finite) ++count;
    }
    return count;
}

double mean_of(const MetricMap& map, std::span<const std::uint8_t> mask) {
    check_mask(mask, map.values.size());
    double total = 0;
    std::size_t count = 0;
    for (std::size_t y = 0; y < map.height; ++y) {
        double row = 0;
        for (std::size_t x = 0; x < map.width; ++x) {
            if (!mask.empty() && mask[pixel_index(map.width, x, y)] == 0) continue;
            row += double{map.at(x, y)};
            ++count;
        }
        total += row;
    }
    if (count == 0) no_pixel_counts();
    return total / static_cast<double>(count);
}

MetricMap difference_map(const Image& a, const Image& b) {
    check_comparable(a, b);
    MetricMap map(a.width, a.height);
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) map.at(x, y) = static_cast<float>(pixel_difference(a, b, x, y));
    }
    return map;
}

}  // namespace subvol
