// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

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

void draw_bar(Image& image, int top) {
    const double last = std::max(image.width - 1, 1);
    for (int y = top; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            set_pixel(image, x, y, y < top + kBarHeight ? heat_color(x / last) : std::array<float, 4>{0, 0, 0, 1});
        }
    }
}

void draw_ticks(Image& image, int top, double scale) {
    for (const double tick : {0.0, 0.5, 1.0}) {
        const int x = static_cast<int>(std::lround(tick * (image.width - 1)));
        for (int y = top; y < top + kTickHeight - 1; ++y) set_pixel(image, x, y, {1, 1, 1, 1});
    }
    const std::string first = tick_text(0), middle = tick_text(scale / 2), last = tick_text(scale);
    const auto width = [](const std::string& text) { return text_width_px(text, kTextSize); };
    const auto write = [&](const std::string& text, double x, TextAnchor anchor) {
        draw_text(image, {x, top + kTickHeight + kTextHeight}, text,
                  {.size_px = kTextSize, .color = Vec3(1), .anchor = anchor});
    };
    const double margin = kRim / 2.0, center = image.width / 2.0, right = image.width - margin;
    const double first_end = margin + width(first) + kRim, last_start = right - width(last) - kRim;
    write(first, margin, TextAnchor::Start);
    // Numbers that would overlap are left out, so a narrow image has fewer.
    if (last_start >= first_end - kRim) write(last, right, TextAnchor::End);
    const bool fits = center - width(middle) / 2 >= first_end && center + width(middle) / 2 <= last_start;
    if (fits) write(middle, center, TextAnchor::Middle);
}

}  // namespace

Image heatmap(const MetricMap& map, double scale) {
    if (map.width < 1 || map.height < 1) throw Error(ErrorCode::InvalidInput, "a map without pixels cannot be drawn");
    if (!(scale >= 0) || !std::isfinite(scale))
        throw Error(ErrorCode::InvalidInput, "the full scale is negative or not finite");
    if (scale == 0) {
        for (const float value : map.values) scale = std::fmax(scale, double{value});
    }
    const int width = static_cast<int>(map.width), height = static_cast<int>(map.height);
    Image heat(width, height + kLegendHeight);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double value{map.at(x, y)};
            set_pixel(heat, x, y, heat_color(value == 0 ? 0 : value / scale));
        }
    }
    draw_bar(heat, height);
    draw_ticks(heat, height + kBarHeight, scale);
    return heat;
}

Image difference_heatmap(const Image& a, const Image& b, double scale) {
    return heatmap(difference_map(a, b), scale);
}

}  // namespace subvol
