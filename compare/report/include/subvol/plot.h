// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "subvol/overlay.h"

namespace subvol {

struct PlotLine {
    std::string name;
    std::vector<double> x, y;
    std::vector<std::size_t> breaks{};  ///< the points, by their indices, that no line joins with the one before
    std::vector<double> spreads{};      ///< half the lengths of bars through the points, along y; empty: there are none
    std::vector<std::size_t> bounds{};  ///< the points, by their indices, whose values are bounds: they are drawn hollow
    bool marked = true;                 ///< points are drawn, where they are not many
};

/// The size of a plot without its legend, and of its letters, in PostScript points. On screens a point is a unit of the view
/// box.
struct PlotSize {
    double width = 480, height = 300, font = 12;
};

inline constexpr PlotSize kColumnPlot{238.11, 160, 7.5};  // 84 mm, a column of a journal
inline constexpr PlotSize kPagePlot{493.23, 280, 9};      // 174 mm, a page

struct Plot {
    std::string title;
    std::string x_label, y_label;
    bool log_x = true, log_y = true;  ///< logarithmic axes; values that are not positive are left out
    bool fit = false;                 ///< show the slope of each line in a log-log plot after its name
    std::vector<PlotLine> lines;
    std::vector<double> x_ticks{};  ///< where the axis has its labels; empty: at round numbers
    /// Values of y at this and beyond are not known better: a grey band from there to the end of the axis, downwards, or
    /// upwards if floor_above.
    std::optional<double> floor{};
    bool floor_above = false;
    std::string floor_name{};  ///< the words for the grey band
};

/// The plot as one SVG element that fills the width of its container, without fonts, scripts or links. Points that are not
/// finite are left out; lines differ in colour and in the shape of their points.
[[nodiscard]] std::string plot_svg(const Plot& plot);

/// The same as a file of its own, with its size and styles.
[[nodiscard]] std::string plot_svg_file(const Plot& plot, const PlotSize& size = {});

/// The same as a page of PDF of the plot's size, with its fonts embedded and without a date: the same bytes in every run with
/// the same fonts and the same version of cairo.
///
/// throws: Error(MissingCapability) if the module of cairo is not installed
[[nodiscard]] std::string plot_pdf(const Plot& plot, const PlotSize& size = {});

/// The same for LaTeX: a tikzpicture of the package pgfplots, with the numbers in it, as wide as a column.
[[nodiscard]] std::string plot_tex(const Plot& plot);

/// The numbers of the plot, a line each: name, x, y, spread, bound ("yes" or "").
[[nodiscard]] std::string plot_csv(const Plot& plot);

/// The slope of log y over log x by least squares: the order of convergence. Nothing with fewer than two positive points at
/// different x.
[[nodiscard]] std::optional<double> fitted_order(const PlotLine& line);

/// The positions of ticks on an axis from min to max, ascending, at least two: 1, 2, 5 times powers of ten; decades on a
/// logarithmic axis that spans several; the ends of a range so narrow that it has only a few numbers.
///
/// min, max: finite, min < max; on a logarithmic axis positive
[[nodiscard]] std::vector<double> ticks(double min, double max, bool log);

/// Writes a vector graphic as `.svg`, or as a page of `.pdf` of its size with the fonts embedded and without a date. The file
/// appears whole under its name or not at all.
///
/// title:  of the document
/// throws: Error(InvalidInput) for another extension, Error(Io), Error(MissingCapability) if a .pdf needs the module of cairo
///         and it is not installed
void write_vector_graphic(const std::filesystem::path& path, const VectorGraphic& graphic, const std::string& title = {});

}  // namespace subvol
