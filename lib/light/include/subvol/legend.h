// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "subvol/transfer_function.h"

namespace subvol {

/// title:    above the legend, e.g. the field's name with its unit
/// min, max: the values shown; of no width, they are widened by .5 either side
/// width_px: of the colour bar, 50..10000
struct LegendOptions {
    std::string title{};
    double min = 0;
    double max = 1;
    int width_px = 360;
};

/// A colour bar with ticks at round values, and the opacity curve above it, as a picture in SVG that needs no other file. On
/// white; colours are sRGB.
///
/// throws: Error(InvalidInput) as validate(function), for a range that is not finite or upside down, or a width out of range
[[nodiscard]] std::string legend_svg(const TransferFunction& function, const LegendOptions& options = {});

/// `legend_svg` as a file, written beside and renamed.
///
/// throws: also Error(Io)
void write_legend(const std::filesystem::path& path, const TransferFunction& function, const LegendOptions& options = {});

}  // namespace subvol
