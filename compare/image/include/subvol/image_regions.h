// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/image_metrics.h"

namespace subvol {

struct ImageRegions {
    PixelMask interior;  ///< the pixels that the object covers, without the band
    PixelMask edge;      ///< the band along the silhouette, 2 band_px wide
};

/// Splits a picture by its object's silhouette. Pixels are covered where alpha is above 0, or in a picture that is opaque
/// everywhere, where they differ from the background. The border of the picture is not a silhouette.
///
/// band_px:    how far the band reaches to either side, along rows, columns and diagonals: ≥ 1
/// background: linear RGB; colours within 1/255 of it (in sRGB) are background too, because of 8-bit files
/// throws:     Error(InvalidInput) if there are no pixels or the band is not positive
[[nodiscard]] ImageRegions silhouette_regions(const Image& reference, int band_px = 2, const Vec3& background = Vec3(0.0));

struct OpticalDepth {
    /// Σ −ln(1−α) over the pixels; times the area of a pixel it is the optical depth of the whole picture, which in an
    /// orthographic view is the volume's integral of the extinction.
    double sum = 0;
    /// Pixels with a transmittance 1−α below 1e-4: a float has few digits for it, and renderers stop there. A transmittance of
    /// 0 counts as 2⁻²⁴.
    std::size_t saturated = 0;
};

/// throws: Error(InvalidInput) if there are no pixels, or values are not finite
[[nodiscard]] OpticalDepth optical_depth(const Image& image);

/// |a − b| / b of the summed optical depths: 0 if they are equal, infinite if only the reference's is 0.
///
/// throws: as `optical_depth`; the sizes must agree
[[nodiscard]] double optical_depth_error(const Image& a, const Image& reference);

}  // namespace subvol
