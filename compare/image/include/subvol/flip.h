// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "subvol/image_metrics.h"

namespace subvol {

/// Pixels a degree of a 3840-pixel screen .7 m wide, seen from .7 m.
inline constexpr double kFlipPixelsPerDegree = 67.020643276582255;

/// mean: over all pixels; map: 0 to 1 a pixel
struct FlipResult {
    double mean = 0;
    MetricMap map;
};

/// LDR-FLIP: how strongly a viewer notices a difference when the two pictures alternate on a screen, 0 to 1.
///
/// Colours are linear RGB over black, cut to [0,1]; beyond the border the picture's last pixels repeat. Both pictures count
/// alike. throws: Error(InvalidInput) if the sizes differ, there are no pixels, some are not finite, or the pixels a degree are
/// not in
///         [1,1000]
/// cost:   linear in pixels and in pixels a degree; parallel, bitwise the same for any number of threads
/// source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild 2020
[[nodiscard]] FlipResult flip(const Image& test, const Image& reference, double pixels_per_degree = kFlipPixelsPerDegree);

/// start, stop: exposures in stops; none: from the reference's luminance: its maximum, its median comes to .85 on the screen.
///              The median is over all pixels; if that is black, over those that are not
struct HdrFlipOptions {
    double pixels_per_degree = kFlipPixelsPerDegree;
    std::optional<double> start{};
    std::optional<double> stop{};
};

/// exposures: how many, from start to stop in equal steps
struct HdrFlipResult {
    double mean = 0;
    MetricMap map;
    double start = 0, stop = 0;
    int exposures = 0;
};

/// HDR-FLIP: per pixel the largest LDR-FLIP over a row of exposures, each after the ACES tone curve. Colours are cut to
/// [0,65536].
///
/// throws: as `flip`; Error(InvalidInput) too for a start beyond the stop, or more than 100 stops between
/// cost:   as many times `flip` as there are exposures
/// source: Andersson, Nilsson, Shirley and Akenine-Möller 2021
[[nodiscard]] HdrFlipResult hdr_flip(const Image& test, const Image& reference, const HdrFlipOptions& options = {});

}  // namespace subvol
