// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "subvol/color_scale.h"
#include "subvol/transfer_function.h"

namespace subvol {

struct LegendOptions {
    std::string title{};  ///< above the legend, e.g. the field's name with its unit
    double min = 0;       ///< start of the range of values
    /// End of the range of values; if the range has no width, a swatch with the value takes the place of the bar
    double max = 1;
    /// The scale of the ticks, which are the ends of the bands, if there are a few; colours of values below and above are the
    /// bar's tips
    ColorShape shape{};
    int width_px = 360;  ///< width of the colour bar, 50..10000
    /// Where the opacities are of another field than the colours, its name: they get a plot of their own; empty: they are of
    /// the same field
    std::string opacity_title{};
    double opacity_min = 0;  ///< start of the range of that field
    double opacity_max = 1;  ///< end of the range of that field
    std::string note{};      ///< a line below the legend
    std::string format{};    ///< format of the ticks' values, as of printf: %.2f, %g, %.3e; empty: as many digits as they need
    /// Names of categories, whose values are `values`, or min, min + 1, … if there are none: the legend has a swatch and the
    /// name for each, in place of the bar
    std::vector<std::string> names{};
    std::vector<double> values{};

    /// The value of the category with a name.
    [[nodiscard]] double value_of(std::size_t name) const {
        return name < values.size() ? values[name] : min + static_cast<double>(name);
    }
};

/// Returns the name of a field with its unit, if it has one: Temp [K].
[[nodiscard]] std::string legend_title(const std::string& field, const std::string& unit);

/// Returns the different values, ascending, if all are integers (blocks, materials) and there are at most 1000; else none.
[[nodiscard]] std::vector<double> categories_of(std::span<const double> values);

/// Gives a legend without names the categories that lie in its range, named by their values.
void name_categories(LegendOptions& options, std::span<const double> categories);

/// Whether a format of ticks has one number, by e, f or g, at most 20 digits, and no other conversion.
[[nodiscard]] bool is_tick_format(const std::string& format);

/// A colour bar with ticks at round values and the opacity curve above it, or the names of categories, as a self-contained SVG
/// picture in sRGB on white.
///
/// throws: Error(InvalidInput) as validate(function), if the range is not finite or min > max, or if the width
///         is out of range
[[nodiscard]] std::string legend_svg(const TransferFunction& function, const LegendOptions& options = {});

/// Writes `legend_svg` to a temporary file, then renames it.
///
/// throws: also Error(Io)
void write_legend(const std::filesystem::path& path, const TransferFunction& function, const LegendOptions& options = {});

}  // namespace subvol
