// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/image_metrics.h"

namespace subvol {

/// edge:     the band along the silhouette, as wide as twice the pixels asked for
/// interior: what the object covers inside that band
struct ImageRegions {
    PixelMask interior;
    PixelMask edge;
};

/// Splits a picture by its object's silhouette. Covered is where alpha is above 0; in a picture that is opaque everywhere, what
/// differs from the background. The border of the picture is no silhouette.
///
/// band_px:    how far the band reaches to either side, along rows, columns and diagonals: ≥ 1
/// background: linear RGB, as a file of 8 bits has it: colours within 1/255 of it (sRGB) are background
/// throws:     Error(InvalidInput) for no pixels or a band that is not positive
[[nodiscard]] ImageRegions silhouette_regions(const Image& reference, int band_px = 2, const Vec3& background = Vec3(0.0));

/// sum:       Σ −ln(1−α) over the pixels; × the area of a pixel it is the optical depth of the whole picture, which under an
///            orthographic view is the volume's integral of the extinction
/// saturated: pixels that let less than 1e-4 through: a float has few digits of that, and renderers stop there. One that lets
///            nothing through counts as if it were 2⁻²⁴
struct OpticalDepth {
    double sum = 0;
    std::size_t saturated = 0;
};

/// throws: Error(InvalidInput) for no pixels, or values that are not finite
[[nodiscard]] OpticalDepth optical_depth(const Image& image);

/// |a − b| / b of the summed optical depths: 0 for equal ones, infinite if only the reference has none.
///
/// throws: as `optical_depth`; the sizes must agree
[[nodiscard]] double optical_depth_error(const Image& a, const Image& reference);

}  // namespace subvol
