// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "figures.h"
#include "subvol/flip.h"
#include "subvol/image.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// The metrics of two pictures, and their heat map.
struct PictureComparison {
    std::string heatmap;
    std::string heatmap_of = "abs";
    std::optional<double> heatmap_scale;
    double pixels_per_degree = kFlipPixelsPerDegree;
    bool hdr = false;
    bool oiio = false;
    bool optical_depth = false;
    std::optional<int> edge_band_px;
    std::string background = "0,0,0";

    void add_to(CLI::App& app);

    /// Before any work is done.
    ///
    /// throws: Error(InvalidInput) if an option is wrong
    void check() const;

    /// The names of the figures that `measure` will give.
    [[nodiscard]] std::vector<std::string> names() const;

    /// Reads and measures; draws the heat map if --heatmap is given.
    ///
    /// throws: Error(InvalidInput) if the sizes differ or pixels are not finite
    [[nodiscard]] Figures measure(const std::string& test, const std::string& reference, Report& report) const;

private:
    static void measure_optical_depth(const Image& a, const Image& b, Figures& figures, Report& report);
    void measure_regions(const Image& a, const Image& b, const MetricMap& flips, Figures& figures) const;
    void draw(const Image& a, const Image& b, const MetricMap& flips, const MetricMap& similarities, Report& report) const;
};

}  // namespace subvol::cli
