// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace subvol {

/// A picture in linear light: RGBA floats, premultiplied, rows from the top.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<float> rgba;  // 4 · width · height

    Image() = default;
    Image(int w, int h) : width(w), height(h), rgba(4 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

    [[nodiscard]] std::span<float, 4> pixel(int x, int y) { return std::span<float, 4>(rgba.data() + 4 * offset(x, y), 4); }
    [[nodiscard]] std::span<const float, 4> pixel(int x, int y) const {
        return std::span<const float, 4>(rgba.data() + 4 * offset(x, y), 4);
    }

private:
    [[nodiscard]] std::size_t offset(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
};

}  // namespace subvol
