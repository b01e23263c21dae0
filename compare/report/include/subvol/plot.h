// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace subvol {

struct PlotLine {
    std::string name;
    std::vector<double> x, y;
};

/// log_x, log_y: decades instead of equal steps; what is not positive is left out there. fit: the slope of each line in decades
/// is told behind its name
struct Plot {
    std::string title;
    std::string x_label, y_label;
    bool log_x = true, log_y = true;
    bool fit = false;
    std::vector<PlotLine> lines;
};

/// The plot as one SVG element, as wide as what it stands in, without fonts, scripts or links of its own. Points that are not
/// finite are left out; lines differ in colour and in the shape of their points.
[[nodiscard]] std::string plot_svg(const Plot& plot);

/// The slope of log y over log x by least squares: the order of convergence. None with less than two positive points at
/// different x.
[[nodiscard]] std::optional<double> fitted_order(const PlotLine& line);

/// Where ticks stand on an axis from min to max, ascending, at least two: 1, 2, 5 times powers of ten; decades on a logarithmic
/// axis that spans several.
[[nodiscard]] std::vector<double> ticks(double min, double max, bool log);

}  // namespace subvol
