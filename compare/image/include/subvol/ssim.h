// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/image_metrics.h"

namespace subvol {

struct SsimResult {
    /// The mean over the pixels whose window lies inside the picture, as in [ssim2004]; over all pixels if the picture is
    /// narrower or lower than a window (11 pixels).
    double mean = 0;
    MetricMap map;  ///< the similarity at each pixel, in [-1,1]
};

/// Structural similarity, the mean of that of red, green and blue; 1 for equal pictures, and symmetric in its arguments.
/// Windows are 11 x 11 pixels, Gaussian with σ = 1.5, and repeat the picture's last pixels beyond its border; the constants are
/// .01² and .03² for a peak of 1. Values are used as given: for 8-bit sRGB pass `srgb8_image`s.
///
/// throws: Error(InvalidInput) if the sizes differ, there are no pixels, or some are not finite
/// cost:   parallel, bitwise the same for any number of threads
/// source: [ssim2004]
[[nodiscard]] SsimResult ssim(const Image& a, const Image& b);

/// The same of one channel, the luminance .2125 R + .7154 G + .0721 B of the values as given. Of `srgb8_image`s it is what
/// scikit-image computes: structural_similarity of rgb2gray with gaussian_weights, sigma 1.5, data_range 1 and without
/// use_sample_covariance.
///
/// throws: as `ssim`
[[nodiscard]] SsimResult luminance_ssim(const Image& a, const Image& b);

}  // namespace subvol
