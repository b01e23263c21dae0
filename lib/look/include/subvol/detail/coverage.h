// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "subvol/image.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// Colour over a pixel. alpha: 0..1
inline void put_over(Image& image, int x, int y, const Vec3& rgb, double alpha) {
    const auto pixel = image.pixel(x, y);
    const auto part = static_cast<float>(alpha);
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = part * static_cast<float>(rgb[static_cast<int>(c)]) + (1 - part) * pixel[c];
    pixel[3] = part + (1 - part) * pixel[3];
}

/// Colour behind a pixel: seen as far as that is transparent.
inline void put_under(Image& image, int x, int y, const Vec3& rgb, double alpha) {
    const auto pixel = image.pixel(x, y);
    const float part = (1 - pixel[3]) * static_cast<float>(alpha);
    for (std::size_t c = 0; c < 3; ++c) pixel[c] += part * static_cast<float>(rgb[static_cast<int>(c)]);
    pixel[3] += part;
}

/// Fills closed polygons, in pixels, by the part of each pixel that is inside. Polygons that turn the other way round are
/// holes.
void fill(Image& image, std::span<const std::vector<Vec2>> polygons, const Vec3& rgb);

/// Calls take(x, y, cover, t) for the pixels of a picture in a line with round ends: cover is the part of the pixel in it,
/// about, and t in 0..1 the nearest place on the line.
void for_each_pixel_of_line(int width, int height, const Vec2& from, const Vec2& to, double width_px,
                            const std::function<void(int, int, double, double)>& take);

}  // namespace subvol::detail
