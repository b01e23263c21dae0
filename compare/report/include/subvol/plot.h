// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace subvol {

/// breaks: the points, by their indices, that no line joins with the one before
struct PlotLine {
    std::string name;
    std::vector<double> x, y;
    std::vector<std::size_t> breaks{};
};

/// log_x, log_y: logarithmic axes; values that are not positive are left out
/// fit:          show the slope of each line in a log-log plot after its name
struct Plot {
    std::string title;
    std::string x_label, y_label;
    bool log_x = true, log_y = true;
    bool fit = false;
    std::vector<PlotLine> lines;
};

/// The plot as one SVG element that fills the width of its container, without fonts, scripts or links. Points that are not
/// finite are left out; lines differ in colour and in the shape of their points.
[[nodiscard]] std::string plot_svg(const Plot& plot);

/// The same as a file of its own, with its size and styles.
[[nodiscard]] std::string plot_svg_file(const Plot& plot);

/// The same as a page of PDF of the plot's size, with its fonts embedded and without a date: the same bytes in every run with
/// the same fonts and the same version of cairo.
///
/// throws: Error(MissingCapability) if the module of cairo is not installed
[[nodiscard]] std::string plot_pdf(const Plot& plot);

/// The slope of log y over log x by least squares: the order of convergence. Nothing with fewer than two positive points at
/// different x.
[[nodiscard]] std::optional<double> fitted_order(const PlotLine& line);

/// The positions of ticks on an axis from min to max, ascending, at least two: 1, 2, 5 times powers of ten; decades on a
/// logarithmic axis that spans several; the ends of a range so narrow that it has only a few numbers.
///
/// min, max: finite, min < max; on a logarithmic axis positive
[[nodiscard]] std::vector<double> ticks(double min, double max, bool log);

}  // namespace subvol
