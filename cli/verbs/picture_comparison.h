// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "figures.h"
#include "subvol/picture_metrics.h"

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
    std::set<std::string> asked;  // flags of metrics that are not always taken
    bool oiio = false;
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
    [[nodiscard]] bool takes(const PictureMetric& metric) const;
    static void warn_of_opaque(const PicturePair& pair, Report& report);
    void measure_regions(const PicturePair& pair, Figures& figures) const;
    void draw(const PicturePair& pair, Report& report) const;
};

}  // namespace subvol::cli
