// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "subvol/vec.h"

namespace subvol::detail {

/// What plots are drawn on. Lengths are in units of the view box, y is down; a unit of a printed plot is a PostScript point.
class Canvas {
public:
    enum class Anchor { Start, Middle, End };

    /// A line of a plot: pen lifts between strands. Its markers have the shape of number `shape`; hollow ones are white inside.
    /// Bars go from one place to another, with a short line across at both ends.
    struct Series {
        std::string color;
        bool dashed = false;
        std::vector<std::vector<Vec2>> strands;
        std::vector<Vec2> markers;
        std::size_t shape = 0;
        std::vector<Vec2> hollow{};
        std::vector<std::pair<Vec2, Vec2>> bars{};
    };

    virtual ~Canvas() = default;

    /// The thin line of a grid.
    virtual void grid(const Vec2& from, const Vec2& to) = 0;
    /// A grey area.
    virtual void band(const Vec2& corner, const Vec2& size) = 0;
    virtual void frame(const Vec2& corner, const Vec2& size) = 0;
    virtual void series(const Series& series) = 0;
    /// size: of the font; upward: turned by 90 degrees about its place
    virtual void text(const Vec2& place, Anchor anchor, const std::string& words, double size, bool upward = false) = 0;
};

/// Okabe and Ito's colours, which colour-blind people can distinguish; without the yellow, which is too pale on white.
inline constexpr std::array<const char*, 7> kPlotColors{"0072b2", "d55e00", "009e73", "cc79a7", "000000", "56b4e9", "e69f00"};

/// Whether an axis can show a value.
[[nodiscard]] inline bool is_shown(double value, bool log) {
    return std::isfinite(value) && (!log || value > 0);
}

inline constexpr double kPlotFont = 12, kBarEnd = 3;

/// The width of a text in DejaVu Sans, which is wider than most; somewhat too much rather than too little.
[[nodiscard]] double text_width(const std::string& words, double size);

class SvgCanvas : public Canvas {
public:
    /// scale: of markers; font: the size of letters that need no attribute
    explicit SvgCanvas(double scale = 1, double font = kPlotFont) : scale_(scale), font_(font) {}

    void band(const Vec2& corner, const Vec2& size) override;
    void grid(const Vec2& from, const Vec2& to) override;
    void frame(const Vec2& corner, const Vec2& size) override;
    void series(const Series& series) override;
    void text(const Vec2& place, Anchor anchor, const std::string& words, double size, bool upward) override;

    /// The elements, without the svg element around them.
    [[nodiscard]] const std::string& elements() const { return svg_; }

private:
    double scale_, font_;
    std::string svg_;
};

/// Text with the special characters of HTML and SVG escaped, also for use in quotes.
[[nodiscard]] std::string escaped(std::string_view text);

/// A coordinate, with two decimals.
[[nodiscard]] std::string coordinate(double value);

}  // namespace subvol::detail
