// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "canvas.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/text_codes.h"

namespace subvol::detail {

namespace {

std::string at(const Vec2& place) {
    return coordinate(place.x) + " " + coordinate(place.y);
}

std::string marker(std::size_t shape, const Vec2& place) {
    const auto path = [&](const std::string& d) { return "<path d=\"M" + at(place) + d + "z\"/>"; };
    switch (shape % 4) {
        case 0:
            return "<circle cx=\"" + coordinate(place.x) + "\" cy=\"" + coordinate(place.y) + "\" r=\"3.4\"/>";
        case 1:
            return path("m-3.2-3.2h6.4v6.4h-6.4");
        case 2:
            return path("m0-4.2l4 7h-8");
        default:
            return path("m0-4.4l4.2 4.4l-4.2 4.4l-4.2-4.4");
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

void SvgCanvas::frame(const Vec2& corner, const Vec2& size) {
    svg_ += "<rect class=\"frame\" x=\"" + coordinate(corner.x) + "\" y=\"" + coordinate(corner.y) + "\" width=\"" +
            coordinate(size.x) + "\" height=\"" + coordinate(size.y) + "\"/>\n";
}

void SvgCanvas::series(const Series& series) {
    std::string path, markers;
    for (const auto& strand : series.strands) {
        for (std::size_t i = 0; i < strand.size(); ++i) path += (i == 0 ? "M" : "L") + at(strand[i]);
    }
    for (const Vec2& place : series.markers) markers += marker(series.shape, place);
    svg_ += "<g stroke=\"" + series.color + "\" fill=\"" + series.color + "\"><path class=\"line\" fill=\"none\" d=\"" + path +
            "\"" + (series.dashed ? " stroke-dasharray=\"5 3\"" : "") + "/>" + markers + "</g>\n";
}

void SvgCanvas::text(const Vec2& place, Anchor anchor, const std::string& words, double size, bool upward) {
    const char* name = anchor == Anchor::Start ? "start" : anchor == Anchor::Middle ? "middle" : "end";
    svg_ += "<text x=\"" + coordinate(place.x) + "\" y=\"" + coordinate(place.y) + "\" text-anchor=\"" + name + "\"" +
            (size == kPlotFont ? "" : " font-size=\"" + coordinate(size) + "\"") +
            (upward ? " transform=\"rotate(-90 " + at(place) + ")\"" : "") + ">" + escaped(words) + "</text>\n";
}

}  // namespace subvol::detail
