// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

namespace subvol {

/// The place of pixel (x, y) among those of a picture whose rows follow each other, from the top. All must be non-negative.
template <std::integral Width, std::integral X, std::integral Y>
[[nodiscard]] constexpr std::size_t pixel_index(Width width, X x, Y y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

/// The number of pixels of a picture.
template <std::integral Width, std::integral Height>
[[nodiscard]] constexpr std::size_t pixel_count(Width width, Height height) {
    return pixel_index(width, 0, height);
}

/// A value at each pixel of a picture, rows from the top: depths, metrics, layers.
template <class T>
struct Raster {
    std::size_t width = 0;
    std::size_t height = 0;
    std::vector<T> values;  // width · height

    Raster() = default;
    template <std::integral Width, std::integral Height>
    Raster(Width w, Height h, const T& value = T{})
        : width(static_cast<std::size_t>(w)), height(static_cast<std::size_t>(h)), values(width * height, value) {}

    template <std::integral X, std::integral Y>
    [[nodiscard]] T& at(X x, Y y) {
        return values[pixel_index(width, x, y)];
    }
    template <std::integral X, std::integral Y>
    [[nodiscard]] const T& at(X x, Y y) const {
        return values[pixel_index(width, x, y)];
    }

    template <std::integral Y>
    [[nodiscard]] std::span<T> row(Y y) {
        return std::span(values).subspan(pixel_index(width, 0, y), width);
    }
    template <std::integral Y>
    [[nodiscard]] std::span<const T> row(Y y) const {
        return std::span(values).subspan(pixel_index(width, 0, y), width);
    }
};

}  // namespace subvol
