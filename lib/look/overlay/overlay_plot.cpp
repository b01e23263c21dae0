// SPDX-License-Identifier: Apache-2.0
// Scales along a picture's sides, and marks with a text beside them.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "subvol/detail/round_ticks.h"
#include "subvol/overlay.h"

namespace subvol {

using namespace detail;
namespace {

constexpr double kTickLength = 0.4, kTickGap = 0.5;  // in letters

double letter_of(int height) {
    return std::clamp(height / 36.0, 9.0, 60.0);
}

std::vector<Tick> ticks_of(const PictureScale& scale, double pixels, double letter) {
    const double low = std::min(scale.first, scale.last), high = std::max(scale.first, scale.last);
    if (!(low < high)) return {{low, ""}};
    const int most = std::clamp(static_cast<int>(pixels / (5 * letter)), 5, 11);
    std::vector<Tick> ticks = round_ticks(low, high, most);
    // Labels side by side need room for the longest of them.
    double widest = 0;
    for (const Tick& tick : ticks) widest = std::max(widest, text_width_px(tick.label, letter));
    const auto each = static_cast<std::size_t>(
        std::max(1.0, std::ceil((widest + letter) * static_cast<double>(ticks.size()) / std::max(1.0, pixels))));
    std::vector<Tick> kept;
    for (std::size_t i = 0; i < ticks.size(); i += each) kept.push_back(ticks[i]);
    return kept;
}

double part_of(const PictureScale& scale, double value) {
    return (value - scale.first) / (scale.last - scale.first);
}

double widest_label(const PictureScale& scale, double pixels, double letter) {
    double width = 0;
    for (const Tick& tick : ticks_of(scale, pixels, letter)) width = std::max(width, text_width_px(tick.label, letter));
    return width;
}

}  // namespace

PlotMargins plot_margins_px(int height, const PictureScale& up) {
    const double letter = letter_of(height);
    const double left = widest_label(up, height, letter) + (kTickLength + 2 * kTickGap) * letter;
    return {.left = static_cast<int>(std::ceil(std::max(left, text_width_px(up.title, letter) + letter))),
            .right = static_cast<int>(std::ceil(1.5 * letter)),
            .top = static_cast<int>(std::ceil(2.2 * letter)),
            .bottom = static_cast<int>(std::ceil(3.6 * letter))};
}

void draw_scales(const DrawTarget& target, const PlotFrame& frame, const PictureScale& across, const PictureScale& up,
                 const Vec3& ink) {
    const double letter = letter_of(frame.height), width = std::max(1.0, letter / 14);
    const Vec2 low(frame.left, frame.top + frame.height), high(frame.left + frame.width, frame.top);
    const auto line = [&](const Vec2& from, const Vec2& to) { draw_line(target, from, to, {.width_px = width, .color = ink}); };
    const std::array<Vec2, 4> corners{{low, {high.x, low.y}, high, {low.x, high.y}}};
    for (std::size_t k = 0; k < 4; ++k) line(corners[k], corners[(k + 1) % 4]);
    const TextOptions middle{.size_px = letter, .color = ink, .anchor = TextAnchor::Middle};
    const TextOptions end{.size_px = letter, .color = ink, .anchor = TextAnchor::End};
    for (const Tick& tick : ticks_of(across, frame.width, letter)) {
        const double x = low.x + part_of(across, tick.value) * frame.width;
        line({x, low.y}, {x, low.y + kTickLength * letter});
        draw_text(target, {x, low.y + (kTickLength + 1.1) * letter}, tick.label, middle);
    }
    for (const Tick& tick : ticks_of(up, frame.height, letter)) {
        const double y = low.y - part_of(up, tick.value) * frame.height;
        line({low.x - kTickLength * letter, y}, {low.x, y});
        draw_text(target, {low.x - (kTickLength + kTickGap) * letter, y + 0.36 * letter}, tick.label, end);
    }
    draw_text(target, {0.5 * (low.x + high.x), low.y + (kTickLength + 2.6) * letter}, across.title, middle);
    draw_text(target, {low.x - (kTickLength + kTickGap) * letter, high.y - 0.9 * letter}, up.title, end);
}

void draw_scales(Image& image, const PlotFrame& frame, const PictureScale& across, const PictureScale& up, const Vec3& ink) {
    draw_scales(DrawTarget(image), frame, across, up, ink);
}

void draw_label(const DrawTarget& target, const Vec2& place, const std::string& text, const TextOptions& options,
                const Vec3& paper) {
    const double size = options.size_px, width = text_width_px(text, size);
    const double part = options.anchor == TextAnchor::Start ? 0 : options.anchor == TextAnchor::Middle ? 0.5 : 1;
    const double left =
        std::clamp(place.x - part * width, 0.2 * size, std::max(0.2 * size, target.width() - width - 0.2 * size));
    const double base = std::clamp(place.y, size, std::max(size, target.height() - 0.4 * size));
    const auto whole = [](double x, double y) { return Vec2(std::trunc(x), std::trunc(y)); };  // pixels
    draw_box(target, whole(left - 0.2 * size, base - 0.9 * size), whole(left + width + 0.2 * size, base + 0.3 * size) + Vec2(1),
             paper, 0.7);
    draw_text(target, {left, base}, text, {.size_px = size, .color = options.color});
}

void draw_label(Image& image, const Vec2& place, const std::string& text, const TextOptions& options, const Vec3& paper) {
    draw_label(DrawTarget(image), place, text, options, paper);
}

void draw_mark(const DrawTarget& target, const Vec2& place, const std::string& text, double size_px, const Vec3& ink,
               const Vec3& paper, bool hidden) {
    if (!(place.x >= 0 && place.y >= 0 && place.x < target.width() && place.y < target.height())) return;
    const double arm = 0.45 * size_px, width = std::max(1.2, size_px / 9);
    const Vec2 x(arm, 0), y(0, arm);
    for (const bool under : {true, false}) {
        const LineOptions line{
            .width_px = under ? 2.4 * width : width, .color = under ? paper : ink, .alpha = hidden ? 0.5 : 1};
        for (const Vec2& side : {x, -x, y, -y}) draw_line(target, place + 0.35 * side, place + side, line);
    }
    const bool at_left = place.x + 0.8 * size_px + text_width_px(text, size_px) < target.width();
    draw_label(target,
               place + Vec2(at_left ? 0.8 * size_px : -0.8 * size_px, place.y > 2 * size_px ? -0.5 * size_px : 1.2 * size_px),
               text, {.size_px = size_px, .color = ink, .anchor = at_left ? TextAnchor::Start : TextAnchor::End}, paper);
}

void draw_mark(Image& image, const Vec2& place, const std::string& text, double size_px, const Vec3& ink, const Vec3& paper,
               bool hidden) {
    draw_mark(DrawTarget(image), place, text, size_px, ink, paper, hidden);
}

}  // namespace subvol
