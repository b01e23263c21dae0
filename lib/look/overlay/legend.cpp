// SPDX-License-Identifier: Apache-2.0
// A legend as an SVG picture. It consists of the title and, from top to bottom:
//
//     1 ┌───────────────┐
//       │ opacity curve │    filled with the colours of the bar
//     0 └───────────────┘
//      ◁│  colour bar   │▷   tips in the colours of values beyond the range
//       ╵   ╵   ╵   ╵   ╵    ticks at round values, or at the ends of the bands
//
// If the opacities are those of another field, their curve comes below the bar, in grey and with its own title and ticks. If
// there are names, of categories or for the one value of a constant field, a swatch and a name for each take the place of all
// this. Values lie along the bar as the colour scale has them, linear or logarithmic. Colours are stops in sRGB at even steps
// and at the knots of the function. Lengths are pixels.
#include "subvol/legend.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <pugixml.hpp>
#include <set>
#include <utility>

#include "subvol/detail/knot_values.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/round_ticks.h"
#include "subvol/error.h"
#include "svg_parts.h"

namespace subvol {

using namespace detail;
namespace {

// Pixels, with room for half a label on either side of the bar, and for the labels of the opacity on its left.
constexpr int kLeft = 56, kRight = 36, kTop = 34, kCurve = 64, kGap = 6, kBar = 18, kBottom = 30;
constexpr int kBarTop = kTop + kCurve + kGap, kBarEnd = kBarTop + kBar;
constexpr int kTip = 18;      // of the bar, for values beyond its ends
constexpr int kRow = 21;      // of a category
constexpr int kApart = 130;   // from the bar down to the plot of the opacities of another field
constexpr int kColors = 128;  // along the bar, besides the knots
constexpr const char* kInk = "#222";
constexpr const char* kColorsUrl = "url(#colors)";

class Legend {
public:
    Legend(const TransferFunction& function, const LegendOptions& options)
        : function_(function),
          options_(options),
          range_(usable_range(options.min, options.max)),
          opacity_range_(options.opacity_title.empty() ? range_ : usable_range(options.opacity_min, options.opacity_max)),
          end_(kLeft + options.width_px) {
        validate(function);
        if (options_.names.empty() && options_.min == options_.max) options_.names = {number_text(options_.min)};
    }

    [[nodiscard]] std::string svg() const {
        const int below =
            named() ? kTop + kRow * static_cast<int>(options_.names.size()) + kGap : kBarEnd + kBottom + (apart() ? kApart : 0);
        pugi::xml_document document;
        const pugi::xml_node svg = append_svg(document, end_ + kRight, below, "#fff",
                                              {{"font-family", "sans-serif"}, {"font-size", "12"}, {"fill", kInk}});
        append_text(svg, 0.5 * (kLeft + end_), 20, "middle",
                    options_.note.empty() ? options_.title : options_.title + ", " + options_.note)
            .append_attribute("style")
            .set_value("font-size:14px;font-weight:bold");
        if (named()) {
            append_names(svg);
        } else {
            append_colors(svg);
            append_opacity(svg);
            append_bar(svg);
        }
        return svg_text(document);
    }

private:
    [[nodiscard]] bool apart() const { return !options_.opacity_title.empty(); }
    [[nodiscard]] bool named() const { return !options_.names.empty(); }
    [[nodiscard]] double part(const KnotRange& range, double value) const {
        return options_.shape.scale.part(value, range.min, range.max);
    }
    [[nodiscard]] double x(const KnotRange& range, double value) const {
        return kLeft + part(range, value) * options_.width_px;
    }
    [[nodiscard]] double y(double alpha) const { return (apart() ? kBarEnd + kApart : kTop + kCurve) - alpha * kCurve; }
    [[nodiscard]] bool inside(double value) const { return value > range_.min && value < range_.max; }

    /// SVG interpolates between stops in sRGB; there are enough of them to make that invisible.
    void append_colors(pugi::xml_node svg) const {
        std::set<double> values;
        for (int i = 0; i <= kColors; ++i)
            values.insert(options_.shape.scale.at(static_cast<double>(i) / kColors, range_.min, range_.max));
        for (const auto& knot : function_.color) {
            if (inside(knot.value)) values.insert(knot.value);
        }
        const auto gradient = append_element(
            svg, "linearGradient",
            {{"id", "colors"}, {"gradientUnits", "userSpaceOnUse"}, {"x1", svg_number(kLeft)}, {"x2", svg_number(end_)}});
        for (const double value : values) {
            append_element(gradient, "stop",
                           {{"offset", svg_number(100 * part(range_, value)) + "%"},
                            {"stop-color", svg_color(color_at(function_, value))}});
        }
    }

    static pugi::xml_node append_text(pugi::xml_node svg, double x, double y, const char* anchor, const std::string& text) {
        pugi::xml_node node =
            append_element(svg, "text", {{"x", svg_number(x)}, {"y", svg_number(y)}, {"text-anchor", anchor}});
        node.text().set(detail::printable(text).c_str());
        return node;
    }

    void append_names(pugi::xml_node svg) const {
        for (std::size_t i = 0; i < options_.names.size(); ++i) {
            const int top = kTop + kRow * static_cast<int>(i);
            append_element(svg, "rect",
                           {{"x", svg_number(kLeft)},
                            {"y", svg_number(top)},
                            {"width", "14"},
                            {"height", "14"},
                            {"fill", svg_color(color_at(function_, options_.value_of(i)))},
                            {"stroke", kInk}});
            append_text(svg, kLeft + 22, top + 12, "start", options_.names[i]);
        }
    }

    void append_opacity(pugi::xml_node svg) const {
        std::string line = "M" + curve_point(opacity_range_.min);
        for (const auto& knot : function_.opacity) {
            if (knot.value > opacity_range_.min && knot.value < opacity_range_.max) line += " L" + curve_point(knot.value);
        }
        line += " L" + curve_point(opacity_range_.max);
        if (apart()) {
            append_text(svg, 0.5 * (kLeft + end_), y(1) - 12, "middle", options_.opacity_title)
                .append_attribute("style")
                .set_value("font-size:14px;font-weight:bold");
            append_ticks(svg, opacity_range_, y(0));
        }
        append_element(
            svg, "path",
            {{"fill", apart() ? "#ddd" : kColorsUrl}, {"d", line + " V" + svg_number(y(0)) + " H" + svg_number(kLeft) + " Z"}});
        for (const int alpha : {0, 1}) {
            append_element(
                svg, "path",
                {{"stroke", "#999"}, {"d", "M" + svg_number(kLeft) + " " + svg_number(y(alpha)) + " H" + svg_number(end_)}});
            append_text(svg, kLeft - 6, y(alpha) + 4, "end", std::to_string(alpha));
        }
        append_element(
            svg, "path",
            {{"fill", "none"}, {"stroke", kInk}, {"stroke-width", "1.5"}, {"stroke-linejoin", "round"}, {"d", line}});
        const std::string turned = "translate(" + svg_number(kLeft - 26) + " " + svg_number(y(0.5)) + ") rotate(-90)";
        append_text(svg, 0, 0, "middle", "opacity").append_attribute("transform").set_value(turned.c_str());
    }

    [[nodiscard]] std::string curve_point(double value) const {
        return svg_number(x(opacity_range_, value)) + " " + svg_number(y(alpha_at(function_, value)));
    }

    void append_bar(pugi::xml_node svg) const {
        append_element(svg, "rect",
                       {{"x", svg_number(kLeft)},
                        {"y", svg_number(kBarTop)},
                        {"width", svg_number(options_.width_px)},
                        {"height", svg_number(kBar)},
                        {"fill", kColorsUrl},
                        {"stroke", kInk}});
        if (options_.shape.below) append_tip(svg, kLeft, -kTip, *options_.shape.below);
        if (options_.shape.above) append_tip(svg, end_, kTip, *options_.shape.above);
        append_ticks(svg, range_, kBarEnd);
    }

    /// A tip of the bar, in the colour of values beyond its end.
    static void append_tip(pugi::xml_node svg, int end, int length, const Vec3& color) {
        const std::string text = "M" + svg_number(end) + " " + svg_number(kBarTop) + " L" + svg_number(end + length) + " " +
                                 svg_number(kBarTop + 0.5 * kBar) + " L" + svg_number(end) + " " + svg_number(kBarEnd) + " Z";
        append_element(svg, "path", {{"fill", svg_color(color)}, {"stroke", kInk}, {"d", text}});
    }

    void append_ticks(pugi::xml_node svg, const KnotRange& range, double top) const {
        const int most = std::clamp(options_.width_px / 50, 5, 11);
        for (const auto& [value, label] : formatted(bar_ticks(options_.shape, range.min, range.max, most), options_.format)) {
            append_element(svg, "path",
                           {{"stroke", kInk}, {"d", "M" + svg_number(x(range, value)) + " " + svg_number(top) + " v5"}});
            append_text(svg, x(range, value), top + 19, "middle", label);
        }
    }

    const TransferFunction& function_;
    LegendOptions options_;
    KnotRange range_, opacity_range_;
    int end_;  // of the bar, in pixels
};

}  // namespace

std::string legend_title(const std::string& field, const std::string& unit) {
    return unit.empty() ? field : field + " [" + unit + "]";
}

std::vector<double> categories_of(std::span<const double> values) {
    constexpr std::size_t kMost = 1000;
    std::set<double> found;
    for (const double value : values) {
        if (value != std::round(value)) return {};
        found.insert(value);
        if (found.size() > kMost) return {};
    }
    return {found.begin(), found.end()};
}

void name_categories(LegendOptions& options, std::span<const double> categories) {
    if (!options.names.empty()) return;
    for (const double value : categories) {
        if (value < options.min || value > options.max) continue;
        options.values.push_back(value);
        options.names.push_back(number_text(value));
    }
}

bool is_tick_format(const std::string& format) {
    const std::size_t percent = format.find('%');
    if (percent == std::string::npos) return false;
    std::size_t at = percent + 1;
    if (at < format.size() && format[at] == '.') {
        const std::size_t digits = at + 1;
        at = std::min(format.find_first_not_of("0123456789", digits), format.size());
        int count = 0;
        const auto [end, error] = std::from_chars(format.data() + digits, format.data() + at, count);
        if (error != std::errc() || count > 20) return false;
    }
    constexpr std::size_t kLongest = 40;
    return at < format.size() && (format[at] == 'e' || format[at] == 'f' || format[at] == 'g') &&
           format.find('%', at) == std::string::npos && format.size() <= kLongest;
}

std::string legend_svg(const TransferFunction& function, const LegendOptions& options) {
    if (options.width_px < 50 || options.width_px > 10000) {
        throw Error(ErrorCode::InvalidInput, "the width is out of range", "legend", "50..10000 pixels");
    }
    return Legend(function, options).svg();
}

void write_legend(const std::filesystem::path& path, const TransferFunction& function, const LegendOptions& options) {
    OutputFile file(path);
    file.write(legend_svg(function, options));
    file.commit();
}

}  // namespace subvol
