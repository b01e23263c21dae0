// SPDX-License-Identifier: Apache-2.0
// Plots of lines over two axes, linear or logarithmic, as SVG and as PDF by the same drawing onto a canvas.
//
//     points ─► range with a margin ─► axes ─► ticks, thinned until labels are apart ─► grid, labels
//            ─► strands between breaks, markers, bars of spreads, hollow markers of bounds
//            ─► band beyond the floor of the reference
//            ─► legend below, in one to three columns
//
// Points that an axis cannot show, such as 0 on a logarithmic one, are left out. Logarithmic ticks are at decades, or at 1, 2
// and 5 of each where there are few; where fewer than two fit, ticks are linear. Lengths are in proportion to the font. The
// order of convergence in the legend is the slope of log y over log x by least squares.
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

// Lengths in units of the view box where letters have the size kPlotFont; others are in proportion.
constexpr double kLeft = 80, kRight = 16, kTop = 12, kBottom = 46;
constexpr double kLegendLine = 18, kLegendMargin = 14, kLegendText = 26;
constexpr double kGap = 6;  // between labels

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

/// The range of all points with a margin; nothing if no point can be shown.
std::optional<Axis> axis_of(const Plot& plot, bool x, double begin, double end) {
    Axis axis{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), x ? plot.log_x : plot.log_y,
              begin, end};
    for (const PlotLine& line : plot.lines) {
        for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
            if (!is_shown(line.x[i], plot.log_x) || !is_shown(line.y[i], plot.log_y)) continue;
            axis.min = std::min(axis.min, x ? line.x[i] : line.y[i]);
            axis.max = std::max(axis.max, x ? line.x[i] : line.y[i]);
            const double bar = x || i >= line.spreads.size() ? 0 : line.spreads[i];
            if (bar > 0 && is_shown(line.y[i] - bar, axis.log)) axis.min = std::min(axis.min, line.y[i] - bar);
            if (bar > 0) axis.max = std::max(axis.max, line.y[i] + bar);
        }
    }
    if (!(axis.min <= axis.max)) return {};
    if (!x && plot.floor && is_shown(*plot.floor, axis.log)) {
        axis.min = std::min(axis.min, *plot.floor);
        axis.max = std::max(axis.max, *plot.floor);
    }
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

/// Leaves out every second label, or more, until none touches the next.
std::vector<Tick> apart(std::vector<Tick> all, const Axis& axis, double gap, const auto& extent) {
    const auto touch = [&](const Tick& a, const Tick& b) {
        return std::abs(axis.at(b.value) - axis.at(a.value)) < (extent(a) + extent(b)) / 2 + gap;
    };
    while (all.size() > 2 && std::ranges::adjacent_find(all, touch) != all.end()) {
        std::vector<Tick> fewer;
        for (std::size_t i = 0; i < all.size(); i += 2) fewer.push_back(all[i]);
        if (fewer.size() < 2) break;
        all = std::move(fewer);
    }
    return all;
}

/// Lines beyond the number of colours are dashed.
Canvas::Series series_of(std::size_t index) {
    return {.color = std::string("#") + kPlotColors[index % kPlotColors.size()],
            .dashed = index >= kPlotColors.size(),
            .strands = {},
            .markers = {},
            .shape = index};
}

/// Whether the places of a line are marked: those of a curve with many would hide it.
bool is_marked(const PlotLine& line) {
    constexpr std::size_t kManyPlaces = 50;
    return line.marked && line.x.size() <= kManyPlaces;
}

std::string legend_words(const Plot& plot, const PlotLine& line) {
    const auto order = plot.fit ? fitted_order(line) : std::nullopt;
    return line.name + (order ? " (" + coordinate(*order) + ")" : "");
}

/// A plot of some size: the frame with the axes, and the legend below.
class Drawing {
public:
    Drawing(const Plot& plot, const PlotSize& size)
        : plot_(plot),
          width_(size.width),
          font_(size.font),
          scale_(size.font / kPlotFont),
          left_(kLeft * scale_),
          right_(size.width - kRight * scale_),
          bottom_(size.height - kBottom * scale_),
          below_(size.height) {}

    [[nodiscard]] double scale() const { return scale_; }
    [[nodiscard]] Vec2 size() const {
        const std::size_t columns = legend_columns(), entries = plot_.lines.size() + (has_floor() ? 1 : 0);
        return {width_, below_ + scale_ * (kLegendLine * static_cast<double>((entries + columns - 1) / columns) + 4)};
    }

    void draw(Canvas& canvas) const {
        const auto x = axis_of(plot_, true, left_, right_), y = axis_of(plot_, false, bottom_, kTop * scale_);
        if (!x || !y) return canvas.text({width_ / 2, below_ / 2}, Canvas::Anchor::Middle, "no data", font_);
        if (has_floor()) draw_floor(*y, canvas);
        draw_axes(*x, *y, canvas);
        for (std::size_t i = 0; i < plot_.lines.size(); ++i) draw_line(i, *x, *y, canvas);
        draw_legend(canvas);
    }

private:
    [[nodiscard]] bool has_floor() const { return plot_.floor && is_shown(*plot_.floor, plot_.log_y); }

    /// A label that would be wider than its place gets a smaller font.
    [[nodiscard]] double font_for(const std::string& label, double room) const {
        return std::min(font_, font_ * room / std::max(text_width(label, font_), 1.));
    }

    void draw_floor(const Axis& y, Canvas& canvas) const {
        const double floor = y.at(*plot_.floor), top = kTop * scale_;
        const double from = plot_.floor_above ? top : floor, to = plot_.floor_above ? floor : bottom_;
        canvas.band({left_, from}, {right_ - left_, to - from});
    }

    [[nodiscard]] std::vector<Tick> x_ticks(const Axis& x) const {
        std::vector<Tick> all;
        for (const double value : plot_.x_ticks) {
            const std::string label = number_text(value, 4);
            if (number_from(label) != value) return labelled_ticks(x.min, x.max, x.log);
            if (value >= x.min && value <= x.max) all.push_back({value, with_superscript(label)});
        }
        return all.empty() ? labelled_ticks(x.min, x.max, x.log) : all;
    }

    void draw_axes(const Axis& x, const Axis& y, Canvas& canvas) const {
        using enum Canvas::Anchor;
        const double top = kTop * scale_, room_x = 64 * scale_, room_y = left_ - (6 + 24) * scale_;  // the title takes 24
        const auto width = [&](const Tick& tick) { return text_width(tick.label, font_for(tick.label, room_x)); };
        for (const auto& [tick, label] : apart(x_ticks(x), x, kGap * scale_, width)) {
            canvas.grid({x.at(tick), top}, {x.at(tick), bottom_});
            // The outermost labels must not leave the picture.
            const double size = font_for(label, room_x), half = text_width(label, size) / 2;
            canvas.text({std::clamp(x.at(tick), half, width_ - half), bottom_ + 16 * scale_}, Middle, label, size);
        }
        const auto height = [&](const Tick&) { return font_; };
        for (const auto& [tick, label] : apart(labelled_ticks(y.min, y.max, y.log), y, kGap * scale_, height)) {
            canvas.grid({left_, y.at(tick)}, {right_, y.at(tick)});
            canvas.text({left_ - 6 * scale_, y.at(tick) + 4 * scale_}, End, label, font_for(label, room_y));
        }
        canvas.frame({left_, top}, {right_ - left_, bottom_ - top});
        canvas.text({(left_ + right_) / 2, below_ - 10 * scale_}, Middle, plot_.x_label,
                    font_for(plot_.x_label, right_ - left_));
        canvas.text({14 * scale_, (top + bottom_) / 2}, Middle, plot_.y_label, font_for(plot_.y_label, bottom_ - top), true);
    }

    void draw_line(std::size_t index, const Axis& x, const Axis& y, Canvas& canvas) const {
        const PlotLine& line = plot_.lines[index];
        Canvas::Series series = series_of(index);
        for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
            if (series.strands.empty() || std::ranges::find(line.breaks, i) != line.breaks.end()) series.strands.emplace_back();
            if (!is_shown(line.x[i], plot_.log_x) || !is_shown(line.y[i], plot_.log_y)) continue;
            const Vec2 place(x.at(line.x[i]), y.at(line.y[i]));
            series.strands.back().push_back(place);
            if (i < line.spreads.size() && line.spreads[i] > 0) {
                const double low = std::max(line.y[i] - line.spreads[i], y.min), high = line.y[i] + line.spreads[i];
                series.bars.emplace_back(Vec2(place.x, y.at(low)), Vec2(place.x, y.at(high)));
            }
            const bool bound = std::ranges::find(line.bounds, i) != line.bounds.end();
            if (bound) series.hollow.push_back(place);
            if (!bound && is_marked(line)) series.markers.push_back(place);
        }
        if (!series.strands.empty()) canvas.series(series);
    }

    /// As many columns as the longest entry leaves room for, at most three.
    [[nodiscard]] std::size_t legend_columns() const {
        double longest = has_floor() ? text_width(plot_.floor_name, font_) : 0;
        for (const PlotLine& line : plot_.lines) longest = std::max(longest, text_width(legend_words(plot_, line), font_));
        const double entry = scale_ * (kLegendText + kGap) + longest;
        return static_cast<std::size_t>(std::clamp(std::floor((width_ - kLegendMargin * scale_) / entry), 1., 3.));
    }

    void draw_legend(Canvas& canvas) const {
        const std::size_t columns = legend_columns();
        const double width = (width_ - kLegendMargin * scale_) / static_cast<double>(columns);
        const auto place = [&](std::size_t i) {
            return Vec2(kLegendMargin * scale_ + width * static_cast<double>(i % columns),
                        below_ + scale_ * (8 + kLegendLine * static_cast<double>(i / columns)));
        };
        const auto name = [&](std::size_t i, const std::string& words) {
            canvas.text(place(i) + scale_ * Vec2(kLegendText, 4), Canvas::Anchor::Start, words,
                        font_for(words, width - kLegendText * scale_));
        };
        for (std::size_t i = 0; i < plot_.lines.size(); ++i) {
            Canvas::Series series = series_of(i);
            series.strands = {{place(i), place(i) + scale_ * Vec2(20, 0)}};
            if (is_marked(plot_.lines[i])) series.markers = {place(i) + scale_ * Vec2(10, 0)};
            canvas.series(series);
            name(i, legend_words(plot_, plot_.lines[i]));
        }
        if (!has_floor()) return;
        canvas.band(place(plot_.lines.size()) - scale_ * Vec2(0, 6), scale_ * Vec2(20, 12));
        name(plot_.lines.size(), plot_.floor_name);
    }

    const Plot& plot_;
    double width_, font_, scale_, left_, right_, bottom_, below_;  // below: where the legend begins
};

std::string svg_element(const Plot& plot, const PlotSize& size, const std::string& attributes, const std::string& style) {
    const Drawing drawing(plot, size);
    SvgCanvas canvas(drawing.scale(), size.font);
    drawing.draw(canvas);
    return "<svg " + attributes + " viewBox=\"0 0 " + coordinate(drawing.size().x) + " " + coordinate(drawing.size().y) +
           "\" role=\"img\" font-size=\"" + coordinate(size.font) + "\"><title>" + escaped(plot.title) + "</title>\n" + style +
           canvas.elements() + "</svg>\n";
}

}  // namespace

std::optional<double> fitted_order(const PlotLine& line) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
        if (!is_shown(line.x[i], true) || !is_shown(line.y[i], true)) continue;
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
    return svg_element(plot, {}, "class=\"plot\"", "");
}

std::string plot_svg_file(const Plot& plot, const PlotSize& size) {
    const Drawing drawing(plot, size);
    const std::string unit = size.font == kPlotFont ? "" : "pt";
    const std::string sides =
        "width=\"" + coordinate(drawing.size().x) + unit + "\" height=\"" + coordinate(drawing.size().y) + unit + "\"";
    const std::string thin = coordinate(drawing.scale()), thick = coordinate(1.8 * drawing.scale());
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
           svg_element(
               plot, size, "xmlns=\"http://www.w3.org/2000/svg\" stroke-width=\"" + thin + "\" " + sides,
               "<style>text { fill: #1c1c1c; font-family: 'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif; stroke: none } "
               ".grid { stroke: #e2e2e2 } .band { fill: #ebebeb } .frame { fill: none; stroke: #777 } .line { stroke-width: " +
                   thick +
                   " }</style>\n"
                   "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
}

std::string plot_pdf(const Plot& plot, const PlotSize& size) {
    const Drawing drawing(plot, size);
    const std::unique_ptr<PdfCanvas> page = cairo("drawing plots as .pdf").page(drawing.size(), drawing.scale(), plot.title);
    drawing.draw(*page);
    std::string fault, bytes = page->file(fault);
    if (!fault.empty()) throw Error(ErrorCode::InvalidInput, "the plot cannot be drawn: " + fault, plot.title);
    return bytes;
}

}  // namespace subvol
