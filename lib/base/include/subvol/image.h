// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "subvol/raster.h"

namespace subvol {

/// A picture in linear light: RGBA floats, premultiplied, rows from the top.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<float> rgba;  // 4 · width · height

    Image() = default;
    Image(int w, int h) : width(w), height(h), rgba(4 * pixel_count(w, h)) {}

    template <std::integral X, std::integral Y>
    [[nodiscard]] std::span<float, 4> pixel(X x, Y y) {
        return std::span<float, 4>(rgba.data() + 4 * pixel_index(width, x, y), 4);
    }
    template <std::integral X, std::integral Y>
    [[nodiscard]] std::span<const float, 4> pixel(X x, Y y) const {
        return std::span<const float, 4>(rgba.data() + 4 * pixel_index(width, x, y), 4);
    }
};

}  // namespace subvol
