// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "subvol/pixel_rows.h"

namespace subvol::detail {

/// Pixels x0 ≤ x < x1, y0 ≤ y < y1; (0,0) is the top left.
struct PixelRect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }

    /// The smallest rectangle that contains both.
    [[nodiscard]] PixelRect with(const PixelRect& other) const {
        if (other.empty()) return *this;
        if (empty()) return other;
        return {std::min(x0, other.x0), std::min(y0, other.y0), std::max(x1, other.x1), std::max(y1, other.y1)};
    }
};

/// Whole rows of a picture; none if they lie beyond it.
[[nodiscard]] inline PixelRect rect_of(const PixelRows& rows, int width, int height) {
    return {0, std::clamp(rows.first, 0, height), width, std::clamp(rows.end, 0, height)};
}

}  // namespace subvol::detail
