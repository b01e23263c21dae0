// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <initializer_list>

#include "canvas.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/text_codes.h"

namespace subvol::detail {

namespace {

std::string at(const Vec2& place) {
    return coordinate(place.x) + " " + coordinate(place.y);
}

std::string marker(std::size_t shape, const Vec2& place, double scale) {
    const auto path = [&](std::initializer_list<Vec2> corners) {
        std::string d;
        for (const Vec2& corner : corners) d += (d.empty() ? "M" : "L") + at(place + scale * corner);
        return "<path d=\"" + d + "z\"/>";
    };
    switch (shape % 4) {
        case 0:
            return "<circle cx=\"" + coordinate(place.x) + "\" cy=\"" + coordinate(place.y) + "\" r=\"" +
                   coordinate(3.4 * scale) + "\"/>";
        case 1:
            return path({{-3.2, -3.2}, {3.2, -3.2}, {3.2, 3.2}, {-3.2, 3.2}});
        case 2:
            return path({{0, -4.2}, {4, 2.8}, {-4, 2.8}});
        default:
            return path({{0, -4.4}, {4.2, 0}, {0, 4.4}, {-4.2, 0}});
    }
}

}  // namespace

std::string escaped(std::string_view text) {
    return xml_escaped(text, XmlQuotes::Any);
}

std::string coordinate(double value) {
    return fixed_text(value, 2);
}

double text_width(const std::string& words, double size) {
    constexpr double kNarrow = .4, kUsual = .64, kWide = 1;  // ems of DejaVu Sans
    double width = 0;
    for (const char c : words) {
        if ((c & 0xC0) == 0x80) continue;  // more bytes of a character
        const bool narrow = std::string(" .,:;'|!ijl()[]").find(c) != std::string::npos;
        const bool wide = std::string("mwMW@%").find(c) != std::string::npos;
        width += narrow ? kNarrow : wide ? kWide : kUsual;
    }
    return width * size;
}

void SvgCanvas::grid(const Vec2& from, const Vec2& to) {
    svg_ += "<line class=\"grid\" x1=\"" + coordinate(from.x) + "\" y1=\"" + coordinate(from.y) + "\" x2=\"" +
            coordinate(to.x) + "\" y2=\"" + coordinate(to.y) + "\"/>\n";
}

void SvgCanvas::band(const Vec2& corner, const Vec2& size) {
    svg_ += "<rect class=\"band\" x=\"" + coordinate(corner.x) + "\" y=\"" + coordinate(corner.y) + "\" width=\"" +
            coordinate(size.x) + "\" height=\"" + coordinate(size.y) + "\"/>\n";
}

void SvgCanvas::frame(const Vec2& corner, const Vec2& size) {
    svg_ += "<rect class=\"frame\" x=\"" + coordinate(corner.x) + "\" y=\"" + coordinate(corner.y) + "\" width=\"" +
            coordinate(size.x) + "\" height=\"" + coordinate(size.y) + "\"/>\n";
}

void SvgCanvas::series(const Series& series) {
    std::string path, markers, hollow, bars;
    for (const auto& strand : series.strands) {
        for (std::size_t i = 0; i < strand.size(); ++i) path += (i == 0 ? "M" : "L") + at(strand[i]);
    }
    for (const auto& [from, to] : series.bars) {
        const double end = kBarEnd * scale_;
        bars += "M" + at(from) + "L" + at(to);
        for (const Vec2& place : {from, to}) bars += "M" + at(place - Vec2(end, 0)) + "L" + at(place + Vec2(end, 0));
    }
    for (const Vec2& place : series.markers) markers += marker(series.shape, place, scale_);
    for (const Vec2& place : series.hollow) hollow += marker(series.shape, place, scale_);
    if (!bars.empty()) bars = "<path class=\"bars\" fill=\"none\" d=\"" + bars + "\"/>";
    if (!hollow.empty()) hollow = "<g class=\"hollow\" fill=\"#fff\">" + hollow + "</g>";
    svg_ += "<g stroke=\"" + series.color + "\" fill=\"" + series.color + "\"><path class=\"line\" fill=\"none\" d=\"" + path +
            "\"" + (series.dashed ? " stroke-dasharray=\"5 3\"" : "") + "/>" + bars + markers + hollow + "</g>\n";
}

void SvgCanvas::text(const Vec2& place, Anchor anchor, const std::string& words, double size, bool upward) {
    const char* name = anchor == Anchor::Start ? "start" : anchor == Anchor::Middle ? "middle" : "end";
    svg_ += "<text x=\"" + coordinate(place.x) + "\" y=\"" + coordinate(place.y) + "\" text-anchor=\"" + name + "\"" +
            (size == font_ ? "" : " font-size=\"" + coordinate(size) + "\"") +
            (upward ? " transform=\"rotate(-90 " + at(place) + ")\"" : "") + ">" + escaped(words) + "</text>\n";
}

}  // namespace subvol::detail
