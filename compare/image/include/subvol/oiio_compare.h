// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "subvol/image.h"

namespace subvol {

/// Thresholds as in the program idiff: a difference is a warning or failure if it is larger than the absolute threshold and
/// larger than the relative threshold times the mean of the two values.
struct OiioOptions {
    float fail = 1e-6f, warn = 1e-6f;
    float fail_relative = 0, warn_relative = 0;
};

struct OiioMetrics {
    double mean_error = 0, rms_error = 0, psnr = 0, max_error = 0;
    std::size_t warnings = 0, failures = 0;  ///< numbers of pixels
};

/// OpenImageIO's own comparison, over red, green, blue and alpha.
///
/// throws: Error(InvalidInput) if the sizes differ or there are no pixels
[[nodiscard]] OiioMetrics compare_oiio(const Image& a, const Image& b, const OiioOptions& options = {});

/// OpenImageIO's version of Yee's perceptual comparison: the number of pixels whose difference is visible.
///
/// luminance: of white on the screen, cd/m²; field_of_view_deg: of the picture, horizontally
/// throws:    as `compare_oiio`, or if pixels are not finite
[[nodiscard]] std::size_t compare_yee(const Image& a, const Image& b, float luminance = 100, float field_of_view_deg = 45);

}  // namespace subvol
