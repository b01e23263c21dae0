// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "subvol/image_metrics.h"

namespace subvol {

/// Pixels per degree of a 3840-pixel screen .7 m wide, seen from .7 m.
inline constexpr double kFlipPixelsPerDegree = 67.020643276582255;

struct FlipResult {
    double mean = 0;  ///< the mean over all pixels
    MetricMap map;    ///< the value at each pixel, 0 to 1
};

/// LDR-FLIP: how strongly a viewer notices a difference when the two pictures alternate on a screen, 0 to 1.
///
/// Colours are linear RGB over black, clamped to [0,1]; beyond the border the picture's last pixels repeat. The result is
/// symmetric in the two pictures.
///
/// throws: Error(InvalidInput) if the sizes differ, there are no pixels, some are not finite, or pixels_per_degree is not in
///         [1,1000]
/// cost:   linear in the number of pixels and in pixels_per_degree; parallel, bitwise the same for any number of threads
/// source: [flip2020]
[[nodiscard]] FlipResult flip(const Image& test, const Image& reference, double pixels_per_degree = kFlipPixelsPerDegree);

struct HdrFlipOptions {
    double pixels_per_degree = kFlipPixelsPerDegree;
    /// Exposure in stops; none: that at which the reference's largest luminance becomes .85 on the screen.
    std::optional<double> start{};
    /// Exposure in stops; none: that at which the reference's median luminance becomes .85 on the screen. If the median pixel
    /// is black, the median is over the pixels that are not.
    std::optional<double> stop{};
};

struct HdrFlipResult {
    double mean = 0;
    MetricMap map;
    double start = 0, stop = 0;
    int exposures = 0;  ///< how many exposures, from start to stop in equal steps
};

/// HDR-FLIP: per pixel the largest LDR-FLIP over a series of exposures, each after the ACES tone curve. Colours are clamped to
/// [0,65536].
///
/// throws: as `flip`, or Error(InvalidInput) if the start is beyond the stop, or more than 100 stops before it
/// cost:   that of `flip` for each exposure
/// source: [hdrflip2021]
[[nodiscard]] HdrFlipResult hdr_flip(const Image& test, const Image& reference, const HdrFlipOptions& options = {});

}  // namespace subvol
