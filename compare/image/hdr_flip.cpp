// SPDX-License-Identifier: Apache-2.0
// HDR-FLIP [hdrflip2021]: FLIP for pictures of high dynamic range, over a series of exposures.
//
//     screen |        _____      A screen shows a part of the range of light at a time, so a difference may be visible at
//      value |      /            some exposures only. At an exposure of s stops, light L has the value T(2ˢ L) on the screen,
//            |    _/             with the tone curve T(x) = (A x² + B x) / (C x² + D x + E).
//            |___/
//            +-------------      map(pixel) = max over s of FLIP(T(2ˢ test), T(2ˢ reference));  mean = its mean over pixels
//               log light
//
// s runs from `start`, which takes the reference's largest luminance to T = .85, to `stop`, which takes its median there:
// max(2, ⌈stop − start⌉) exposures in equal steps of about one stop.
#include <algorithm>
#include <cmath>

#include "image_difference.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/flip.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kMostStops = 100;
constexpr double kBrightest = 65536;
constexpr double kScreen = .85;  // the screen value of the reference's maximum at `start` and of its median at `stop`

// Narkowicz's fit to the tone curve of ACES, with the exposure of .6 that it omits.
constexpr double kA = .6 * .6 * 2.51, kB = .6 * .03, kC = .6 * .6 * 2.43, kD = .6 * .59, kE = .14;

double tone(double x) {
    return std::clamp((kA * x * x + kB * x) / (kC * x * x + kD * x + kE), 0.0, 1.0);
}

/// The light that gives a value on the screen: the positive root of tone(x) = value.
double light_of(double value) {
    const double a = kA - value * kC, b = kB - value * kD, c = -value * kE;
    return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

double cut(float value) {
    return std::clamp(static_cast<double>(value), 0.0, kBrightest);
}

Image exposed(const Image& image, double stops) {
    Image screen(image.width, image.height);
    const double factor = std::exp2(stops);
    for (std::size_t i = 0; i < image.rgba.size(); ++i) {
        screen.rgba[i] = i % 4 == 3 ? 1.0f : static_cast<float>(tone(factor * cut(image.rgba[i])));
    }
    return screen;
}

std::vector<double> luminances(const Image& image) {
    std::vector<double> all;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        all.push_back(.2126 * cut(image.rgba[i]) + .7152 * cut(image.rgba[i + 1]) + .0722 * cut(image.rgba[i + 2]));
    }
    return all;
}

/// The median; of an even number of values the lower of the two in the middle.
double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The exposures at which the reference's maximum and its median become kScreen; 0 and 0 if it is black.
std::pair<double, double> exposures_of(const Image& reference) {
    std::vector<double> light = luminances(reference);
    const double largest = *std::max_element(light.begin(), light.end());
    if (largest == 0) return {0, 0};
    double middle = median(light);
    if (middle == 0) {
        std::erase(light, 0.0);
        middle = median(light);
    }
    return {std::log2(light_of(kScreen) / largest), std::log2(light_of(kScreen) / middle)};
}

}  // namespace

HdrFlipResult hdr_flip(const Image& test, const Image& reference, const HdrFlipOptions& options) {
    check_finite(test, reference);
    const auto [start, stop] = exposures_of(reference);
    HdrFlipResult result{.map = {}, .start = options.start.value_or(start), .stop = options.stop.value_or(stop)};
    const double range = result.stop - result.start;
    if (!(range >= 0 && range <= kMostStops)) {
        throw Error(
            ErrorCode::InvalidInput,
            "exposures from " + number_text(result.start) + " to " + number_text(result.stop) + " stops are out of range", {},
            "a start not beyond the stop, at most 100 stops");
    }
    result.exposures = std::max(2, static_cast<int>(std::ceil(range)));
    const double step = range / (result.exposures - 1);
    result.map = MetricMap(test.width, test.height);
    for (int k = 0; k < result.exposures; ++k) {
        const double stops = result.start + k * step;
        const MetricMap map = flip(exposed(test, stops), exposed(reference, stops), options.pixels_per_degree).map;
        for (std::size_t i = 0; i < map.values.size(); ++i) {
            result.map.values[i] = std::max(result.map.values[i], map.values[i]);
        }
    }
    result.mean = mean_of(result.map);
    return result;
}

}  // namespace subvol
