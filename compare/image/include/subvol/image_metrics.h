// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "subvol/image.h"
#include "subvol/raster.h"
#include "subvol/vec.h"

namespace subvol {

/// Differences over red, green and blue of all pixels, for a peak of 1. psnr is infinite for equal images.
struct ImageMetrics {
    double mse = 0, rmse = 0, mae = 0, max = 0, psnr = 0;
};

/// Which pixels count: one number per pixel, rows from the top, 0 for those that do not. An empty mask means all pixels.
using PixelMask = std::vector<std::uint8_t>;

/// The value of a metric at each pixel.
using MetricMap = Raster<float>;

/// throws: Error(InvalidInput) if the sizes differ, there are no pixels, or none of them counts
[[nodiscard]] ImageMetrics compare_images(const Image& a, const Image& b, std::span<const std::uint8_t> mask = {});

/// The picture as `write_image` stores it in a .png: red, green and blue are the encoded 8-bit values / 255, not linear, and
/// alpha is 1. Metrics of two such pictures are metrics on 8-bit sRGB.
///
/// background: linear RGB
[[nodiscard]] Image srgb8_image(const Image& image, const Vec3& background = Vec3(0.0));

/// How many pixels have a colour or alpha that is infinite or not a number.
[[nodiscard]] std::size_t count_not_finite(const Image& image);

/// The mean over the pixels that count.
///
/// throws: Error(InvalidInput) if there are none
[[nodiscard]] double mean_of(const MetricMap& map, std::span<const std::uint8_t> mask = {});

/// Per pixel the largest absolute difference of red, green and blue.
///
/// throws: Error(InvalidInput) if the sizes differ or there are no pixels
[[nodiscard]] MetricMap difference_map(const Image& a, const Image& b);

/// A map as a picture in the colours of inferno (black over red to pale yellow), with 30 rows of legend below: a bar, and the
/// numbers at its ends and middle as far as there is room.
///
/// scale:  the value that gets the last colour; 0: the largest value of the map
/// throws: Error(InvalidInput) if there are no pixels or the scale is negative
[[nodiscard]] Image heatmap(const MetricMap& map, double scale = 0);

/// A map in the same colours on a logarithmic scale from 1e-4 to 1, the same in every picture: maps of several pictures can be
/// compared. Smaller values are black.
///
/// throws: Error(InvalidInput) if there are no pixels
[[nodiscard]] Image log_heatmap(const MetricMap& map);

/// The mean difference of red, green and blue with its sign, on the same scale to both sides: orange where a is brighter, blue
/// where it is darker, black where they differ by less than 1e-4.
///
/// throws: Error(InvalidInput) if the sizes differ or there are no pixels
[[nodiscard]] Image sign_heatmap(const Image& a, const Image& b);

/// `heatmap` of the `difference_map`.
[[nodiscard]] Image difference_heatmap(const Image& a, const Image& b, double scale = 0);

}  // namespace subvol
