// SPDX-License-Identifier: Apache-2.0
#include "subvol/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "html_text.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/round_ticks.h"

namespace subvol {

using namespace detail;

namespace {

// All lengths are in units of the view box, which is scaled to the page.
constexpr double kWidth = 480, kPlotHeight = 300;
constexpr double kLeft = 62, kRight = 14, kTop = 12, kBottom = 46;
constexpr double kLegendLine = 18, kFont = 12;

/// Okabe and Ito's colours, which colour-blind people can distinguish; without the yellow, which is too pale on white.
constexpr std::array<const char*, 7> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#56b4e9", "#e69f00"};

std::string number(double value) {
    return fixed_text(value, 2);
}

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

std::string text_at(double x, double y, const std::string& anchor, const std::string& words, const std::string& more = {}) {
    return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" +
           escaped(words) + "</text>\n";
}

std::string line_at(double x0, double y0, double x1, double y1, const char* name) {
    return "<line class=\"" + std::string(name) + "\" x1=\"" + number(x0) + "\" y1=\"" + number(y0) + "\" x2=\"" + number(x1) +
           "\" y2=\"" + number(y1) + "\"/>\n";
}

/// A smaller font for a label that would be wider than its place.
std::string fitting(const std::string& label) {
    constexpr std::size_t kFits = 8;
    return label.size() <= kFits ? "" : " font-size=\"" + number(kFont * kFits / static_cast<double>(label.size())) + '"';
}

std::string frame(const Plot& plot, const Axis& x, const Axis& y) {
    std::string svg;
    for (const auto& [tick, label] : labelled_ticks(x.min, x.max, x.log)) {
        svg += line_at(x.at(tick), kTop, x.at(tick), kPlotHeight - kBottom, "grid");
        svg += text_at(x.at(tick), kPlotHeight - kBottom + 16, "middle", label, fitting(label));
    }
    for (const auto& [tick, label] : labelled_ticks(y.min, y.max, y.log)) {
        svg += line_at(kLeft, y.at(tick), kWidth - kRight, y.at(tick), "grid");
        svg += text_at(kLeft - 6, y.at(tick) + 4, "end", label, fitting(label));
    }
    svg += "<rect class=\"frame\" x=\"" + number(kLeft) + "\" y=\"" + number(kTop) + "\" width=\"" +
           number(kWidth - kLeft - kRight) + "\" height=\"" + number(kPlotHeight - kTop - kBottom) + "\"/>\n";
    svg += text_at((kLeft + kWidth - kRight) / 2, kPlotHeight - 10, "middle", plot.x_label);
    const double middle = (kTop + kPlotHeight - kBottom) / 2;
    svg += text_at(14, middle, "middle", plot.y_label, " transform=\"rotate(-90 14 " + number(middle) + ")\"");
    return svg;
}

std::string marker(std::size_t which, double x, double y) {
    const auto path = [&](const std::string& d) { return "<path d=\"M" + number(x) + " " + number(y) + d + "z\"/>"; };
    switch (which % 4) {
        case 0:
            return "<circle cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"3.4\"/>";
        case 1:
            return path("m-3.2-3.2h6.4v6.4h-6.4");
        case 2:
            return path("m0-4.2l4 7h-8");
        default:
            return path("m0-4.4l4.2 4.4l-4.2 4.4l-4.2-4.4");
    }
}

// Lines beyond the number of colours are dashed.
std::string colored_line(std::size_t index, const std::string& path, const std::string& markers) {
    const std::string color = kColors[index % kColors.size()];
    const std::string dash = index < kColors.size() ? "" : " stroke-dasharray=\"5 3\"";
    return "<g stroke=\"" + color + "\" fill=\"" + color + "\"><path class=\"line\" fill=\"none\" d=\"" + path + "\"" + dash +
           "/>" + markers + "</g>\n";
}

std::string line_svg(const Plot& plot, std::size_t index, const Axis& x, const Axis& y) {
    const PlotLine& line = plot.lines[index];
    std::string path, points;
    for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
        if (!shown(line.x[i], plot.log_x) || !shown(line.y[i], plot.log_y)) continue;
        const double px = x.at(line.x[i]), py = y.at(line.y[i]);
        path += (path.empty() ? "M" : "L") + number(px) + " " + number(py);
        points += marker(index, px, py);
    }
    return path.empty() ? std::string() : colored_line(index, path, points);
}

std::string legend(const Plot& plot, std::size_t columns) {
    std::string svg;
    for (std::size_t i = 0; i < plot.lines.size(); ++i) {
        const std::size_t row = i / columns;
        const double x = 14 + (kWidth - 14) / static_cast<double>(columns) * static_cast<double>(i % columns);
        const double y = kPlotHeight + 8 + kLegendLine * static_cast<double>(row);
        svg += colored_line(i, "M" + number(x) + " " + number(y) + "h20", marker(i, x + 10, y));
        std::string words = plot.lines[i].name;
        const auto order = plot.fit ? fitted_order(plot.lines[i]) : std::nullopt;
        if (order) words += " (" + number(*order) + ")";
        svg += text_at(x + 26, y + 4, "start", words);
    }
    return svg;
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
    const auto x = axis_of(plot, true, kLeft, kWidth - kRight), y = axis_of(plot, false, kPlotHeight - kBottom, kTop);
    std::size_t longest = 0;
    for (const PlotLine& line : plot.lines) longest = std::max(longest, line.name.size());
    const std::size_t columns = longest > 30 ? 1 : 2;
    const double rows = std::ceil(static_cast<double>(plot.lines.size()) / static_cast<double>(columns));
    const double height = kPlotHeight + kLegendLine * rows + 4;
    std::string svg = "<svg class=\"plot\" viewBox=\"0 0 " + number(kWidth) + " " + number(height) +
                      "\" role=\"img\" font-size=\"" + number(kFont) + "\"><title>" + escaped(plot.title) + "</title>\n";
    if (!x || !y) return svg + text_at(kWidth / 2, kPlotHeight / 2, "middle", "no data") + "</svg>\n";
    svg += frame(plot, *x, *y);
    for (std::size_t i = 0; i < plot.lines.size(); ++i) svg += line_svg(plot, i, *x, *y);
    return svg + legend(plot, columns) + "</svg>\n";
}

}  // namespace subvol
