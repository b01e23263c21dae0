// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "canvas.h"
#include "subvol/detail/number_text.h"
#include "subvol/plot.h"
#include "subvol/study_table.h"

// The numbers of a plot: for LaTeX, where pgfplots draws them, and for programs.

namespace subvol {

using namespace detail;

namespace {

constexpr std::array<const char*, 4> kMarks{"*", "square*", "triangle*", "diamond*"};  // those of the canvas

bool is_bound(const PlotLine& line, std::size_t i) {
    return std::ranges::find(line.bounds, i) != line.bounds.end();
}

double spread(const PlotLine& line, std::size_t i) {
    return i < line.spreads.size() ? line.spreads[i] : 0;
}

/// The points of one strand after the other; pgfplots lifts the pen at an empty line.
std::string coordinates(const Plot& plot, const PlotLine& line) {
    std::string text;
    for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
        if (!is_shown(line.x[i], plot.log_x) || !is_shown(line.y[i], plot.log_y)) continue;
        if (std::ranges::find(line.breaks, i) != line.breaks.end()) text += "\n";
        text += "    (" + exact_text(line.x[i]) + "," + exact_text(line.y[i]) + ") +- (0," + exact_text(spread(line, i)) + ")" +
                (is_bound(line, i) ? " % a bound" : "") + "\n";
    }
    return text;
}

}  // namespace

std::string plot_tex(const Plot& plot) {
    std::string text = "% \\usepackage{pgfplots} \\pgfplotsset{compat=1.16}\n";
    for (std::size_t i = 0; i < std::min(plot.lines.size(), kPlotColors.size()); ++i)
        text += "\\definecolor{subvol" + std::to_string(i) + "}{HTML}{" + kPlotColors[i] + "}\n";
    text += "\\begin{tikzpicture}\n\\begin{axis}[width=84mm, height=60mm, grid=major, xlabel={" + tex_text(plot.x_label) +
            "}, ylabel={" + tex_text(plot.y_label) + "}, " + (plot.log_x ? "xmode=log, " : "") +
            (plot.log_y ? "ymode=log, " : "");
    if (!plot.x_ticks.empty()) {
        std::string ticks;
        for (const double tick : plot.x_ticks) ticks += (ticks.empty() ? "" : ",") + exact_text(tick);
        text += "xtick={" + ticks + "}, " + (plot.log_x ? "log ticks with fixed point, " : "");
    }
    text += "legend style={at={(0.5,-0.25)}, anchor=north, draw=none, font=\\footnotesize}, unbounded coords=jump]\n";
    for (std::size_t l = 0; l < plot.lines.size(); ++l) {
        const PlotLine& line = plot.lines[l];
        text += "\\addplot+[color=subvol" + std::to_string(l % kPlotColors.size()) + ", mark=" + kMarks[l % kMarks.size()] +
                (l >= kPlotColors.size() ? ", dashed" : ", solid") +
                ", error bars/.cd, y dir=both, y explicit] coordinates {\n" + coordinates(plot, line) +
                "};\n\\addlegendentry{" + tex_text(line.name) + "}\n";
    }
    if (plot.floor && is_shown(*plot.floor, plot.log_y)) {
        text += "\\draw[gray, dashed] ({rel axis cs:0,0}|-{axis cs:1," + exact_text(*plot.floor) +
                "}) -- ({rel axis cs:1,0}|-{axis cs:1," + exact_text(*plot.floor) + "}); % " + plot.floor_name + "\n";
    }
    return text + "\\end{axis}\n\\end{tikzpicture}\n";
}

std::string plot_csv(const Plot& plot) {
    std::string text = "name,x,y,spread,bound\n";
    for (const PlotLine& line : plot.lines) {
        std::string name;
        for (const char c : line.name) name += c == '"' ? std::string("\"\"") : std::string(1, c);
        for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
            text += '"' + name + "\"," + exact_text(line.x[i]) + "," + exact_text(line.y[i]) + "," +
                    exact_text(spread(line, i)) + "," + (is_bound(line, i) ? "yes" : "") + "\n";
        }
    }
    return text;
}

}  // namespace subvol
