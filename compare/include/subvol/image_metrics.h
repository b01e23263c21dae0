#pragma once

#include "subvol/image.h"

namespace subvol {

/// Differences over linear RGB, all pixels and channels, peak 1. psnr is infinite for equal images.
struct ImageMetrics {
    double mse = 0, rmse = 0, mae = 0, max = 0, psnr = 0;
};

/// throws: Error(InvalidInput) if the sizes differ or there are no pixels
[[nodiscard]] ImageMetrics compare_images(const Image& a, const Image& b);

/// The difference as a picture: per pixel the largest channel difference through the map inferno (black over red to pale
/// yellow), 30 rows of legend below: a bar and the numbers at its ends and middle, as far as there is room.
///
/// scale:  the difference that takes the last colour; 0: the largest difference
/// throws: Error(InvalidInput) if the sizes differ or the scale is negative
[[nodiscard]] Image difference_heatmap(const Image& a, const Image& b, double scale = 0);

}  // namespace subvol
