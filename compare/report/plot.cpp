// SPDX-License-Identifier: Apache-2.0
#include "subvol/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "canvas.h"
#include "pdf_canvas.h"
#include "subvol/detail/module.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/round_ticks.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

// All lengths are in units of the view box, which is scaled to the page.
constexpr double kWidth = 480, kPlotHeight = 300;
constexpr double kLeft = 80, kRight = 16, kTop = 12, kBottom = 46;
constexpr double kLegendLine = 18, kLegendMargin = 14, kLegendText = 26;
constexpr double kGap = 6;  // between labels

/// Okabe and Ito's colours, which colour-blind people can distinguish; without the yellow, which is too pale on white.
constexpr std::array<const char*, 7> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#56b4e9", "#e69f00"};

std::string superscript(int value) {
    static constexpr std::array<const char*, 10> kDigits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = value < 0 ? "⁻" : "";
    for (const char digit : std::to_string(std::abs(value))) text += kDigits[static_cast<std::size_t>(digit - '0')];
    return text;
}

/// The label m · 10^decade.
std::string decade_label(double m, int decade) {
    if (std::abs(decade) < 4) return number_text(m * std::pow(10, decade), 4);
    return (m == 1 ? "" : number_text(m) + "·") + "10" + superscript(decade);
}

/// A power of ten as in print: "1.5e+07" becomes "1.5·10⁷".
std::string with_superscript(const std::string& label) {
    const std::size_t e = label.find('e');
    if (e == std::string::npos) return label;
    const auto exponent = number_from(std::string_view(label).substr(e + 1));
    return label.substr(0, e) + "·10" + superscript(static_cast<int>(exponent.value_or(0)));
}

/// Ticks at decades or parts of them; fewer than two if the axis is too short for them.
std::vector<Tick> decade_ticks(double min, double max) {
    const double low = std::log10(min), high = std::log10(max), decades = high - low;
    const int first = static_cast<int>(std::floor(low)), last = static_cast<int>(std::ceil(high));
    const int step = std::max(1, static_cast<int>(std::ceil(decades / 7)));
    std::vector<Tick> all;
    for (int decade = first; decade <= last; decade += step) {
        for (const double m : {1., 2., 5.}) {
            if (m != 1 && decades > 2.2) continue;
            const double tick = m * std::pow(10, decade);
            if (tick >= min && tick <= max) all.push_back({tick, decade_label(m, decade)});
        }
    }
    return all;
}

std::vector<Tick> labelled_ticks(double min, double max, bool log) {
    if (log) {
        if (auto all = decade_ticks(min, max); all.size() >= 2) return all;
    }
    auto all = round_ticks(min, max);
    for (Tick& tick : all) tick.label = with_superscript(tick.label);
    return all;
}

/// An axis, which maps values to positions.
struct Axis {
    double min = 0, max = 1;
    bool log = false;
    double begin = 0, end = 1;

    [[nodiscard]] double at(double value) const { return begin + part(value) * (end - begin); }

private:
    [[nodiscard]] double part(double value) const {
        if (log) return (std::log(value) - std::log(min)) / (std::log(max) - std::log(min));
        if (std::isfinite(max - min)) return (value - min) / (max - min);
        return (value / 2 - min / 2) / (max / 2 - min / 2);
    }
};

bool shown(double value, bool log) {
    return std::isfinite(value) && (!log || value > 0);
}

/// The range of all points with a margin; nothing if no point can be shown.
std::optional<Axis> axis_of(const Plot& plot, bool x, double begin, double end) {
    Axis axis{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), x ? plot.log_x : plot.log_y,
              begin, end};
    for (const PlotLine& line : plot.lines) {
        for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
            if (!shown(line.x[i], plot.log_x) || !shown(line.y[i], plot.log_y)) continue;
            axis.min = std::min(axis.min, x ? line.x[i] : line.y[i]);
            axis.max = std::max(axis.max, x ? line.x[i] : line.y[i]);
        }
    }
    if (!(axis.min <= axis.max)) return {};
    constexpr double kMost = std::numeric_limits<double>::max(), kLeast = std::numeric_limits<double>::min();
    if (axis.log) {
        const double room = std::max(std::exp(.06 * (std::log(axis.max) - std::log(axis.min))), 1.15);
        axis.min = std::max(axis.min / room, std::min(axis.min, kLeast));
        axis.max = std::min(axis.max * room, kMost);
    } else {
        const double room = axis.max > axis.min ? .06 * axis.max - .06 * axis.min : std::max(std::abs(axis.max), 1.) / 2;
        axis.min = std::max(axis.min - room, -kMost);
        axis.max = std::min(axis.max + room, kMost);
    }
    return axis;
}

/// A label that would be wider than its place gets a smaller font.
double font_for(const std::string& label, double room) {
    return std::min(kPlotFont, kPlotFont * room / std::max(text_width(label, kPlotFont), 1.));
}

/// Leaves out every second label, or more, until none touches the next.
std::vector<Tick> apart(std::vector<Tick> all, const Axis& axis, const auto& extent) {
    const auto touch = [&](const Tick& a, const Tick& b) {
        return std::abs(axis.at(b.value) - axis.at(a.value)) < (extent(a) + extent(b)) / 2 + kGap;
    };
    while (all.size() > 2 && std::ranges::adjacent_find(all, touch) != all.end()) {
        std::vector<Tick> fewer;
        for (std::size_t i = 0; i < all.size(); i += 2) fewer.push_back(all[i]);
        if (fewer.size() < 2) break;
        all = std::move(fewer);
    }
    return all;
}

void draw_axes(const Plot& plot, const Axis& x, const Axis& y, Canvas& canvas) {
    using enum Canvas::Anchor;
    constexpr double kRoomX = 64, kRoomY = kLeft - 6 - 24;  // the title of the axis takes 24
    const double bottom = kPlotHeight - kBottom, right = kWidth - kRight;
    const auto width = [&](const Tick& tick) { return text_width(tick.label, font_for(tick.label, kRoomX)); };
    for (const auto& [tick, label] : apart(labelled_ticks(x.min, x.max, x.log), x, width)) {
        canvas.grid({x.at(tick), kTop}, {x.at(tick), bottom});
        // The outermost labels must not leave the picture.
        const double size = font_for(label, kRoomX), half = text_width(label, size) / 2;
        canvas.text({std::clamp(x.at(tick), half, kWidth - half), bottom + 16}, Middle, label, size);
    }
    const auto height = [](const Tick&) { return kPlotFont; };
    for (const auto& [tick, label] : apart(labelled_ticks(y.min, y.max, y.log), y, height)) {
        canvas.grid({kLeft, y.at(tick)}, {right, y.at(tick)});
        canvas.text({kLeft - 6, y.at(tick) + 4}, End, label, font_for(label, kRoomY));
    }
    canvas.frame({kLeft, kTop}, {right - kLeft, bottom - kTop});
    canvas.text({(kLeft + right) / 2, kPlotHeight - 10}, Middle, plot.x_label, font_for(plot.x_label, right - kLeft));
    canvas.text({14, (kTop + bottom) / 2}, Middle, plot.y_label, font_for(plot.y_label, bottom - kTop), true);
}

/// Lines beyond the number of colours are dashed.
Canvas::Series series_of(std::size_t index) {
    return {.color = kColors[index % kColors.size()],
            .dashed = index >= kColors.size(),
            .strands = {},
            .markers = {},
            .shape = index};
}

/// Whether the places of a line are marked: those of a curve with many would hide it.
bool is_marked(const PlotLine& line) {
    constexpr std::size_t kManyPlaces = 50;
    return line.x.size() <= kManyPlaces;
}

void draw_line(const Plot& plot, std::size_t index, const Axis& x, const Axis& y, Canvas& canvas) {
    const PlotLine& line = plot.lines[index];
    Canvas::Series series = series_of(index);
    for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
        if (series.strands.empty() || std::ranges::find(line.breaks, i) != line.breaks.end()) series.strands.emplace_back();
        if (!shown(line.x[i], plot.log_x) || !shown(line.y[i], plot.log_y)) continue;
        series.strands.back().emplace_back(x.at(line.x[i]), y.at(line.y[i]));
        if (is_marked(line)) series.markers.push_back(series.strands.back().back());
    }
    if (!series.strands.empty()) canvas.series(series);
}

std::string legend_words(const Plot& plot, const PlotLine& line) {
    const auto order = plot.fit ? fitted_order(line) : std::nullopt;
    return line.name + (order ? " (" + coordinate(*order) + ")" : "");
}

/// As many columns as the longest entry leaves room for, at most three.
std::size_t legend_columns(const Plot& plot) {
    double longest = 0;
    for (const PlotLine& line : plot.lines) longest = std::max(longest, text_width(legend_words(plot, line), kPlotFont));
    const double entry = kLegendText + longest + kGap;
    return static_cast<std::size_t>(std::clamp(std::floor((kWidth - kLegendMargin) / entry), 1., 3.));
}

void draw_legend(const Plot& plot, std::size_t columns, Canvas& canvas) {
    const double width = (kWidth - kLegendMargin) / static_cast<double>(columns);
    for (std::size_t i = 0; i < plot.lines.size(); ++i) {
        const double x = kLegendMargin + width * static_cast<double>(i % columns);
        const double y = kPlotHeight + 8 + kLegendLine * static_cast<double>(i / columns);
        Canvas::Series series = series_of(i);
        series.strands = {{{x, y}, {x + 20, y}}};
        if (is_marked(plot.lines[i])) series.markers = {{x + 10, y}};
        canvas.series(series);
        const std::string words = legend_words(plot, plot.lines[i]);
        canvas.text({x + kLegendText, y + 4}, Canvas::Anchor::Start, words, font_for(words, width - kLegendText));
    }
}

double height_of(const Plot& plot) {
    const std::size_t columns = legend_columns(plot);
    return kPlotHeight + kLegendLine * static_cast<double>((plot.lines.size() + columns - 1) / columns) + 4;
}

void draw(const Plot& plot, Canvas& canvas) {
    const auto x = axis_of(plot, true, kLeft, kWidth - kRight), y = axis_of(plot, false, kPlotHeight - kBottom, kTop);
    if (!x || !y) return canvas.text({kWidth / 2, kPlotHeight / 2}, Canvas::Anchor::Middle, "no data", kPlotFont);
    draw_axes(plot, *x, *y, canvas);
    for (std::size_t i = 0; i < plot.lines.size(); ++i) draw_line(plot, i, *x, *y, canvas);
    draw_legend(plot, legend_columns(plot), canvas);
}

std::string svg_element(const Plot& plot, const std::string& attributes, const std::string& style) {
    SvgCanvas canvas;
    draw(plot, canvas);
    return "<svg " + attributes + " viewBox=\"0 0 " + coordinate(kWidth) + " " + coordinate(height_of(plot)) +
           "\" role=\"img\" font-size=\"" + coordinate(kPlotFont) + "\"><title>" + escaped(plot.title) + "</title>\n" + style +
           canvas.elements() + "</svg>\n";
}

}  // namespace

std::optional<double> fitted_order(const PlotLine& line) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
        if (!shown(line.x[i], true) || !shown(line.y[i], true)) continue;
        const double x = std::log(line.x[i]), y = std::log(line.y[i]);
        n += 1;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    const double spread = n * sxx - sx * sx;
    if (n < 2 || !(spread > 1e-12 * n * sxx)) return {};
    return (n * sxy - sx * sy) / spread;
}

std::vector<double> ticks(double min, double max, bool log) {
    std::vector<double> all;
    for (const Tick& tick : labelled_ticks(min, max, log)) all.push_back(tick.value);
    return all;
}

std::string plot_svg(const Plot& plot) {
    return svg_element(plot, "class=\"plot\"", "");
}

std::string plot_svg_file(const Plot& plot) {
    const std::string size = "width=\"" + coordinate(kWidth) + "\" height=\"" + coordinate(height_of(plot)) + "\"";
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
           svg_element(
               plot, "xmlns=\"http://www.w3.org/2000/svg\" " + size,
               "<style>text { fill: #1c1c1c; font-family: 'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif; stroke: none } "
               ".grid { stroke: #e2e2e2 } .frame { fill: none; stroke: #777 } .line { stroke-width: 1.8 }</style>\n"
               "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
}

std::string plot_pdf(const Plot& plot) {
    using Entry = const CairoFunctions* (*)();
    static const CairoFunctions& functions = *reinterpret_cast<Entry>(load_module("cairo", "drawing plots as .pdf"))();
    const std::unique_ptr<PdfCanvas> page = functions.page({kWidth, height_of(plot)}, plot.title);
    draw(plot, *page);
    std::string fault, bytes = page->file(fault);
    if (!fault.empty()) throw Error(ErrorCode::InvalidInput, "the plot cannot be drawn: " + fault, plot.title);
    return bytes;
}

}  // namespace subvol
