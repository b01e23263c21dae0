// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "image_difference.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/image_metrics.h"
#include "subvol/overlay.h"
#include "subvol/srgb.h"

namespace subvol {

namespace {

// inferno by N. J. Smith and S. van der Walt (matplotlib 1.5, CC0) at ninths of its range, in 8-bit sRGB.
constexpr std::array<std::array<int, 3>, 10> kInferno{{{0, 0, 4},
                                                       {27, 12, 65},
                                                       {74, 12, 107},
                                                       {120, 28, 109},
                                                       {165, 44, 96},
                                                       {207, 68, 70},
                                                       {237, 105, 37},
                                                       {251, 155, 6},
                                                       {247, 209, 61},
                                                       {252, 255, 164}}};

// The legend, from top to bottom: the bar, ticks, numbers, a margin.
constexpr int kBarHeight = 12, kTickHeight = 4, kTextHeight = 10, kRim = 4;
constexpr int kLegendHeight = kBarHeight + kTickHeight + kTextHeight + kRim;
constexpr double kTextSize = 14;  // of an em, pixels; capitals are .73 of it high

std::array<float, 4> heat_color(double fraction) {
    const double place = (kInferno.size() - 1) * (std::isnan(fraction) ? 1.0 : std::clamp(fraction, 0.0, 1.0));
    const auto knot = std::min(static_cast<std::size_t>(place), kInferno.size() - 2);
    const double beyond = place - static_cast<double>(knot);
    std::array<float, 4> rgba{0, 0, 0, 1};
    for (std::size_t c = 0; c < 3; ++c) {
        const double encoded = (1 - beyond) * kInferno[knot][c] + beyond * kInferno[knot + 1][c];
        rgba[c] = static_cast<float>(linear_from_srgb(encoded / 255));
    }
    return rgba;
}

void set_pixel(Image& image, int x, int y, const std::array<float, 4>& rgba) {
    std::copy(rgba.begin(), rgba.end(), image.pixel(x, y).begin());
}

std::string tick_text(double value) {
    return detail::number_text(value, 3);
}

/// A number below the bar, at a part of the width.
struct BarTick {
    double place = 0;
    std::string words;
};

/// The legend below the map. color: of a part of the width
void draw_bar(Image& image, int top, const std::function<std::array<float, 4>(double)>& color) {
    const double last = std::max(image.width - 1, 1);
    for (int y = top; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            set_pixel(image, x, y, y < top + kBarHeight ? color(x / last) : std::array<float, 4>{0, 0, 0, 1});
        }
    }
}

/// Numbers that would overlap those before are left out, so a narrow image has fewer.
void draw_ticks(Image& image, int top, std::span<const BarTick> ticks) {
    for (const BarTick& tick : ticks) {
        const int x = static_cast<int>(std::lround(tick.place * (image.width - 1)));
        for (int y = top; y < top + kTickHeight - 1; ++y) set_pixel(image, x, y, {1, 1, 1, 1});
    }
    const double margin = kRim / 2.0;
    std::vector<std::pair<double, double>> taken;
    for (const BarTick& tick : ticks) {
        const double width = text_width_px(tick.words, kTextSize), most = image.width - margin - width;
        const double left = std::max(margin, std::min(tick.place * image.width - width / 2, most)), right = left + width;
        const bool free = std::ranges::none_of(
            taken, [&](const auto& other) { return left < other.second + kRim && right > other.first - kRim; });
        if (!free && !taken.empty()) continue;
        taken.emplace_back(left, right);
        draw_text(image, {left, top + kTickHeight + kTextHeight}, tick.words,
                  {.size_px = kTextSize, .color = Vec3(1), .anchor = TextAnchor::Start});
    }
}

constexpr double kLeastShown = 1e-4;
constexpr int kDecades = 4;

/// The part of the logarithmic scale: 0 at kLeastShown and below, 1 at 1.
double log_part(double value) {
    return std::isnan(value) ? 1 : std::clamp(1 + std::log10(std::max(value, kLeastShown)) / kDecades, 0.0, 1.0);
}

/// part: -1 to 1
std::array<float, 4> sign_color(double part) {
    constexpr Vec3 kOrange{.9, .6, 0}, kBlue{.34, .71, .91};  // Okabe and Ito's, encoded
    const Vec3 color = linear_from_srgb(std::abs(part) * (part < 0 ? kBlue : kOrange));
    return {static_cast<float>(color.x), static_cast<float>(color.y), static_cast<float>(color.z), 1};
}

Image with_legend(int width, int height, const std::function<std::array<float, 4>(int, int)>& pixel,
                  const std::function<std::array<float, 4>(double)>& bar, std::span<const BarTick> ticks) {
    if (width < 1 || height < 1) throw Error(ErrorCode::InvalidInput, "a map without pixels cannot be drawn");
    Image heat(width, height + kLegendHeight);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) set_pixel(heat, x, y, pixel(x, y));
    }
    draw_bar(heat, height, bar);
    draw_ticks(heat, height + kBarHeight, ticks);
    return heat;
}

Image with_legend(const MetricMap& map, const std::function<double(double)>& part, std::span<const BarTick> ticks) {
    return with_legend(
        static_cast<int>(map.width), static_cast<int>(map.height),
        [&](int x, int y) { return heat_color(part(double{map.at(x, y)})); }, heat_color, ticks);
}

}  // namespace

Image heatmap(const MetricMap& map, double scale) {
    if (!(scale >= 0) || !std::isfinite(scale))
        throw Error(ErrorCode::InvalidInput, "the full scale is negative or not finite");
    if (scale == 0) {
        for (const float value : map.values) scale = std::fmax(scale, double{value});
    }
    const std::vector<BarTick> ticks{{0, tick_text(0)}, {1, tick_text(scale)}, {.5, tick_text(scale / 2)}};
    return with_legend(
        map, [&](double value) { return value == 0 ? 0 : value / scale; }, ticks);
}

Image log_heatmap(const MetricMap& map) {
    const std::vector<BarTick> ticks{{0, "1e-4"}, {1, "1"}, {.5, ".01"}, {.25, ".001"}, {.75, ".1"}};
    return with_legend(map, log_part, ticks);
}

Image sign_heatmap(const Image& a, const Image& b) {
    detail::check_comparable(a, b);
    const auto pixel = [&](int x, int y) {
        double difference = 0;
        for (std::size_t c = 0; c < 3; ++c) difference += (double{a.pixel(x, y)[c]} - double{b.pixel(x, y)[c]}) / 3;
        return sign_color(std::copysign(log_part(std::abs(difference)), difference));
    };
    const std::vector<BarTick> ticks{{0, "-1"}, {1, "1"}, {.5, "0"}, {.25, "-.01"}, {.75, ".01"}};
    return with_legend(
        a.width, a.height, pixel, [](double part) { return sign_color(2 * part - 1); }, ticks);
}

Image difference_heatmap(const Image& a, const Image& b, double scale) {
    return heatmap(difference_map(a, b), scale);
}

}  // namespace subvol
