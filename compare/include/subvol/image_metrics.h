#pragma once

#include "subvol/image.h"

namespace subvol {

/// Differences over linear RGB, all pixels and channels, peak 1. psnr is infinite for equal images.
struct ImageMetrics {
    double mse = 0, rmse = 0, mae = 0, max = 0, psnr = 0;
};

/// throws: Error(InvalidInput) if the sizes differ
[[nodiscard]] ImageMetrics compare_images(const Image& a, const Image& b);

/// The difference as a picture: per pixel the largest channel difference through a perceptual map from black to white, the
/// full scale being `scale`; a legend below says so. scale 0: the largest difference.
[[nodiscard]] Image difference_heatmap(const Image& a, const Image& b, double scale = 0);

}  // namespace subvol
