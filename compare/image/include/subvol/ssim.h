// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/image_metrics.h"

namespace subvol {

/// map: the channels' mean at each pixel, in [-1,1]; mean: over the pixels whose window lies inside the picture, as its
/// authors have it, or over all where there are none (less than 11 pixels a side)
struct SsimResult {
    double mean = 0;
    MetricMap map;
};

/// Structural similarity, the mean of that of red, green and blue; 1 for equal pictures, and the same when they change places.
/// Windows are 11 x 11 pixels, Gaussian with σ = 1.5, and repeat the picture's last pixels beyond its border; the constants
/// are .01² and .03² for a peak of 1. Values are taken as they are: for 8-bit sRGB give it `srgb8_image`s.
///
/// throws: Error(InvalidInput) if the sizes differ, there are no pixels, or some are not finite
/// cost:   parallel, bitwise the same for any number of threads
/// source: Wang, Bovik, Sheikh and Simoncelli 2004
[[nodiscard]] SsimResult ssim(const Image& a, const Image& b);

}  // namespace subvol
