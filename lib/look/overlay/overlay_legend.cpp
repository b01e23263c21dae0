// SPDX-License-Identifier: Apache-2.0
// A legend that is painted into a picture, at its right side or along its lower edge:
//
//     title                       title, note
//     opacity │ bar │─ label      ◁│ bar                    │▷
//      curve  │     │─ label          ╵ label   ╵ label   ╵
//     note
//
// All lengths are multiples of the letter's size, which is a part of the picture's shorter side between limits. The extent is
// known before anything is drawn, so that the picture can be made large enough: at the side, of the titles up to a part of the
// shorter side, or of bar and labels, whichever is wider. The curve of the opacity is drawn at the side alone, and left out
// where the opacity is the same everywhere; that of another field lies below the bar. Categories are swatches with names; where
// there is no room for all, the last entry says how many more there are.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "subvol/detail/knot_values.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/round_ticks.h"
#include "subvol/overlay.h"

namespace subvol {

using namespace detail;
namespace {

constexpr double kMostOfSide = 0.45;  // a longer title is cut off
constexpr double kLeastLetter_px = 8;
constexpr double kOverlap = 2;    // pixels of a step of the bar, of which the next step covers one: no seam is seen in vectors
constexpr double kNameRow = 1.7;  // of a category, in letters

/// A legend without a bar has names: of categories, or the value of a constant field.
LegendOptions with_names(LegendOptions options) {
    if (options.names.empty() && options.min == options.max) options.names = {number_text(options.min)};
    return options;
}

bool varies(const TransferFunction& function) {
    return std::ranges::any_of(function.opacity,
                               [&](const auto& knot) { return knot.alpha != function.opacity.front().alpha; });
}

/// A bar, its ticks and its title from the top, at one size of letters.
class LegendPainter {
public:
    LegendPainter(const TransferFunction& function, const LegendOptions& options, const LegendStyle& style, int height)
        : function_(function),
          options_(with_names(options)),
          colors_(usable_range(options.min, options.max)),
          opacities_(options.opacity_title.empty() ? colors_ : usable_range(options.opacity_min, options.opacity_max)),
          height_(height),
          shorter_(style.width > 0 ? std::min(style.width, height) : height),
          letter_(std::max(kLeastLetter_px, style.size * std::clamp(shorter_ / 40, kLeastLetter_px, 120.0))),
          ink_(style.ink) {
        validate(function);
    }

    [[nodiscard]] int width() const {
        const double most = kMostOfSide * shorter_;
        if (!options_.names.empty()) return static_cast<int>(std::ceil(std::min(names_width(), most) + 2 * margin()));
        const double titles = std::max(
            {title_width(options_.title), title_width(options_.note), apart() ? title_width(options_.opacity_title) : 0.0});
        const double bars = curve_width() + bar_width() + 0.9 * letter_ +
                            std::max(labels_width(colors_), apart() ? labels_width(opacities_) : 0.0);
        return static_cast<int>(std::ceil(std::max(std::min(titles, most), bars) + 2 * margin()));
    }

    /// The rows of a legend along the lower edge: title, bar and labels, or the title and one row of names.
    [[nodiscard]] int rows() const { return static_cast<int>(std::ceil((options_.names.empty() ? 5.6 : 4.2) * letter_)); }

    void draw_below(const DrawTarget& target) {
        target_ = &target;
        const double top = target.height() - rows();
        left_ = margin() + 0.5 * letter_;
        std::string title = options_.title;
        if (!options_.note.empty()) title += ", " + options_.note;
        draw_title(title, top + 1.4 * letter_);
        const double y0 = top + 2.1 * letter_;
        if (!options_.names.empty()) return draw_names_below(y0);
        double right = target.width() - left_;
        const double y1 = y0 + bar_width(), middle = 0.5 * (y0 + y1);
        const double left = left_ + (options_.shape.below ? bar_width() : 0);
        if (options_.shape.below) draw_tip({left_, middle}, {left, middle}, *options_.shape.below);
        if (options_.shape.above) {
            draw_tip({right, middle}, {right - bar_width(), middle}, *options_.shape.above);
            right -= bar_width();
        }
        for (int x = static_cast<int>(left); x < static_cast<int>(right); ++x) {
            const double part = (x + 0.5 - left) / (right - left);
            const Vec3 color = color_at(function_, options_.shape.scale.at(part, colors_.min, colors_.max));
            draw_box(*target_, whole(x, y0), whole(std::min(x + kOverlap, right), y1), color);
        }
        draw_frame(static_cast<int>(left), static_cast<int>(y0), static_cast<int>(right), static_cast<int>(y1));
        for (const auto& [value, label] : side_by_side(ticks(colors_), right - left)) {
            const double x = left + part_of(colors_, value) * (right - left);
            line({x, y1}, {x, y1 + 0.4 * letter_}, 1);
            const double half = 0.5 * text_width_px(label, letter_);
            write({std::clamp(x, half, target.width() - half), y1 + 1.5 * letter_}, label, TextAnchor::Middle);
        }
    }

    void draw(const DrawTarget& target) {
        target_ = &target;
        left_ = target.width() - width() + margin();
        const double bottom = height_ - (options_.note.empty() ? 2.2 : 4) * letter_;
        if (!options_.note.empty()) draw_title(options_.note, height_ - 0.7 * letter_);
        if (!options_.names.empty()) return draw_names(bottom);
        const double middle = apart() ? 0.56 * height_ : bottom;
        draw_bar(2.2 * letter_, middle);
        if (apart()) {
            draw_title(options_.opacity_title, middle + 3.2 * letter_);
            draw_curve(left_ + bar_width() + curve_width(), middle + 4.4 * letter_, bottom, opacities_);
        }
    }

private:
    [[nodiscard]] double part_of(const KnotRange& range, double value) const {
        return options_.shape.scale.part(value, range.min, range.max);
    }
    [[nodiscard]] bool apart() const { return !options_.opacity_title.empty(); }
    [[nodiscard]] double margin() const { return 0.9 * letter_; }
    [[nodiscard]] double bar_width() const { return 1.3 * letter_; }
    [[nodiscard]] double curve_width() const {
        return !apart() && varies(function_) ? 2.6 * letter_ : apart() ? 2.6 * letter_ : 0;
    }
    [[nodiscard]] double title_width(const std::string& title) const { return text_width_px(title, 1.08 * letter_); }
    [[nodiscard]] std::vector<Tick> ticks(const KnotRange& range) const {
        return formatted(bar_ticks(options_.shape, range.min, range.max, apart() ? 5 : 8), options_.format);
    }
    /// Every n-th tick, so that there is room for the labels of all that are left.
    [[nodiscard]] std::vector<Tick> side_by_side(const std::vector<Tick>& ticks, double room) const {
        double widest = 0;
        for (const Tick& tick : ticks) widest = std::max(widest, text_width_px(tick.label, letter_));
        const double needed = (widest + 0.5 * letter_) * static_cast<double>(ticks.size() - 1);
        const auto step = static_cast<std::size_t>(std::clamp(std::ceil(needed / room), 1.0, 1e6));
        std::vector<Tick> kept;
        for (std::size_t i = 0; i < ticks.size(); i += step) kept.push_back(ticks[i]);
        return kept;
    }
    [[nodiscard]] double labels_width(const KnotRange& range) const {
        double width = 0;
        for (const auto& [value, label] : ticks(range)) width = std::max(width, text_width_px(label, letter_));
        return width;
    }

    void write(const Vec2& place, const std::string& text, TextAnchor anchor = TextAnchor::Start, double size = 1) const {
        draw_text(*target_, place, text, {.size_px = size * letter_, .color = ink_, .anchor = anchor});
    }

    void draw_title(const std::string& title, double base) const { write_within({left_, base}, title, 1.08); }

    /// Writes a text up to the picture's edge.
    void write_within(const Vec2& place, const std::string& text, double size) const {
        write(place, cut_text(text, size * letter_, target_->width() - place.x - 0.3 * margin()), TextAnchor::Start, size);
    }

    [[nodiscard]] double names_width() const {
        double width = std::max(title_width(options_.title), title_width(options_.note));
        for (const std::string& name : options_.names)
            width = std::max(width, kNameRow * letter_ + text_width_px(name, letter_));
        return width;
    }

    /// A row for each category. Where there are too many, the last row says how many more there are.
    void draw_names(double bottom) const {
        draw_title(options_.title, 2.2 * letter_);
        const double top = 3.4 * letter_, row = kNameRow * letter_;
        const auto rows = static_cast<std::size_t>(std::max(1.0, std::floor((bottom - top) / row)));
        const std::size_t count = options_.names.size(), shown = count <= rows ? count : rows - 1;
        for (std::size_t i = 0; i < shown; ++i) {
            const double y = top + static_cast<double>(i) * row;
            const Vec3 color = color_at(function_, options_.value_of(i));
            draw_swatch(left_, y, color);
            write_within({left_ + row, y + 0.92 * letter_}, options_.names[i], 1);
        }
        if (shown < count) {
            const double y = top + static_cast<double>(shown) * row;
            write_within({left_ + row, y + 0.92 * letter_}, "and " + std::to_string(count - shown) + " more", 1);
        }
    }

    /// As many names side by side as there is room for.
    void draw_names_below(double y) const {
        double x = left_;
        const double row = kNameRow * letter_, base = y + 0.92 * letter_;
        for (std::size_t i = 0; i < options_.names.size(); ++i) {
            const bool last = i + 1 == options_.names.size();
            const double width = row + text_width_px(options_.names[i], letter_) + letter_;
            if (x + width + (last ? 0 : 6 * letter_) > target_->width())
                return write({x, base}, "and " + std::to_string(options_.names.size() - i) + " more");
            draw_swatch(x, y, color_at(function_, options_.value_of(i)));
            write({x + row, base}, options_.names[i]);
            x += width;
        }
    }

    void draw_swatch(double x, double y, const Vec3& color) const {
        const int x0 = static_cast<int>(x), y0 = static_cast<int>(y), side = static_cast<int>(1.1 * letter_);
        draw_box(*target_, Vec2(x0, y0), Vec2(x0 + side, y0 + side), color);
        draw_frame(x0, y0, x0 + side, y0 + side);
    }

    /// A tip of the bar, in the colour of values beyond its end. from: the tip; to: the middle of the bar's end
    void draw_tip(const Vec2& from, const Vec2& to, const Vec3& color) const {
        const Vec2 side = 0.5 * Vec2(to.y - from.y, from.x - to.x);
        const Vec2 a = to + side, b = to - side;
        draw_area(*target_, std::array{from, a, b}, color);
        line(from, a, 1);
        line(from, b, 1);
    }

    /// The corner of the pixel that a place is in.
    static Vec2 whole(double x, double y) { return {std::trunc(x), std::trunc(y)}; }

    void draw_bar(double title_base, double bottom) const {
        draw_title(options_.title, title_base);
        double top = title_base + 1.2 * letter_;
        const double start = left_ + (apart() ? 0 : curve_width()), end = start + bar_width(), middle = 0.5 * (start + end);
        if (options_.shape.above) {
            draw_tip({middle, top}, {middle, top + bar_width()}, *options_.shape.above);
            top += bar_width();
        }
        if (options_.shape.below) {
            draw_tip({middle, bottom}, {middle, bottom - bar_width()}, *options_.shape.below);
            bottom -= bar_width();
        }
        const int x0 = static_cast<int>(start), x1 = static_cast<int>(end);
        for (int y = static_cast<int>(top); y < static_cast<int>(bottom); ++y) {
            const Vec3 color =
                color_at(function_, options_.shape.scale.at((bottom - y - 0.5) / (bottom - top), colors_.min, colors_.max));
            draw_box(*target_, Vec2(x0, y), whole(x1, std::min(y + kOverlap, bottom)), color);
        }
        draw_frame(x0, static_cast<int>(top), x1, static_cast<int>(bottom));
        draw_ticks(x1, static_cast<int>(top), static_cast<int>(bottom), colors_);
        if (!apart() && curve_width() > 0) draw_curve(start, top, bottom, colors_);
    }

    void draw_frame(double x0, double y0, double x1, double y1) const {
        const std::array<Vec2, 4> corners{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}};
        for (std::size_t i = 0; i < 4; ++i) line(corners[i], corners[(i + 1) % 4], 1);
    }

    void line(const Vec2& from, const Vec2& to, double width) const {
        draw_line(*target_, from, to, {.width_px = width * std::max(1.0, letter_ / 14), .color = ink_});
    }

    void draw_ticks(double x, double top, double bottom, const KnotRange& range) const {
        for (const auto& [value, label] : ticks(range)) {
            const double y = bottom - part_of(range, value) * (bottom - top);
            line({x, y}, {x + 0.4 * letter_, y}, 1);
            write({x + 0.8 * letter_, y + 0.36 * letter_}, label);
        }
    }

    /// The opacity, 0 at the right edge and 1 at the left.
    void draw_curve(double right, double top, double bottom, const KnotRange& range) const {
        const double width = curve_width() - 0.5 * letter_;
        const auto place = [&](double value) {
            return Vec2(right - alpha_at(function_, value) * width, bottom - part_of(range, value) * (bottom - top));
        };
        std::vector<double> values{range.min};
        for (const auto& knot : function_.opacity) {
            if (knot.value > range.min && knot.value < range.max) values.push_back(knot.value);
        }
        values.push_back(range.max);
        for (std::size_t i = 0; i + 1 < values.size(); ++i) line(place(values[i]), place(values[i + 1]), 1.6);
        line({right, top}, {right, bottom}, 1);
        const double size = std::max(0.8, kLeastLetter_px / letter_);
        write({right - width, bottom + 1.2 * letter_}, "1", TextAnchor::Middle, size);
        write({right, bottom + 1.2 * letter_}, "0", TextAnchor::Middle, size);
        write({right - 0.5 * width, bottom + 2 * letter_}, "opacity", TextAnchor::Middle, size);
        if (apart()) draw_ticks(right, top, bottom, range);
    }

    const TransferFunction& function_;
    LegendOptions options_;
    KnotRange colors_, opacities_;
    double height_, shorter_, letter_;
    const DrawTarget* target_ = nullptr;
    Vec3 ink_{0.0};
    double left_ = 0;
};

}  // namespace

Image padded(const Image& image, int left, int top, int width, int height) {
    Image all(width, height);
    for (int y = 0; y < image.height; ++y) {
        const float* const row = image.rgba.data() + 4 * pixel_index(image.width, 0, y);
        std::copy_n(row, 4 * static_cast<std::size_t>(image.width), all.pixel(left, top + y).data());
    }
    return all;
}

int legend_extent_px(const TransferFunction& function, const LegendOptions& options, const LegendStyle& style, int height) {
    const LegendPainter painter(function, options, style, height);
    return style.side == LegendSide::Right ? painter.width() : painter.rows();
}

void draw_legend(Image& image, const TransferFunction& function, const LegendOptions& options, const LegendStyle& style,
                 int height) {
    draw_legend(DrawTarget(image), function, options, style, height);
}

void draw_legend(const DrawTarget& target, const TransferFunction& function, const LegendOptions& options,
                 const LegendStyle& style, int height) {
    LegendPainter painter(function, options, style, height);
    if (style.side == LegendSide::Right) {
        painter.draw(target);
    } else {
        painter.draw_below(target);
    }
}

}  // namespace subvol
