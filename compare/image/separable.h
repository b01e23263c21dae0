// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "subvol/raster.h"

namespace subvol::detail {

/// The weights of a filter at −r … r, 2r + 1 of them.
using Taps = std::vector<double>;

using Plane = Raster<double>;

/// Filters rows with `across` (beyond their ends the last values repeat), then columns with `down`. The first and last `halo`
/// rows of the plane are only read: the result has 2 · halo rows less.
///
/// halo: at least the radius of `down`
[[nodiscard]] Plane convolved(const Plane& plane, const Taps& across, const Taps& down, std::size_t halo);

/// A normalised Gaussian. sigma: in pixels
[[nodiscard]] Taps gaussian_taps(double sigma, std::size_t radius);

/// Rows begin … end − 1 of a picture, and `halo` more rows on both sides; rows beyond the picture repeat its first or last row.
struct Band {
    std::size_t begin = 0, end = 0, halo = 0, height = 0;

    [[nodiscard]] std::size_t rows() const { return end - begin + 2 * halo; }
    [[nodiscard]] std::size_t picture_row(std::size_t row) const {
        return std::clamp(begin + row, halo, halo + height - 1) - halo;
    }
};

/// Calls work for bands that cover all rows, in parallel; the bands do not depend on the number of threads.
void for_each_band(std::size_t height, std::size_t halo, const std::function<void(const Band&)>& work);

}  // namespace subvol::detail
