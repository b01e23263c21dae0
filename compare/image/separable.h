// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

namespace subvol::detail {

/// The weights of a filter at −r … r, 2r + 1 of them.
using Taps = std::vector<double>;

/// A two-dimensional array, stored by rows.
struct Plane {
    int width = 0;
    int height = 0;
    std::vector<double> values;

    Plane() = default;
    Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

    [[nodiscard]] double* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
    [[nodiscard]] const double* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

/// Filters rows with `across` (beyond their ends the last values repeat), then columns with `down`. The first and last `halo`
/// rows of the plane are only read: the result has 2 · halo rows less.
///
/// halo: at least the radius of `down`
[[nodiscard]] Plane convolved(const Plane& plane, const Taps& across, const Taps& down, int halo);

/// A normalised Gaussian. sigma: in pixels
[[nodiscard]] Taps gaussian_taps(double sigma, int radius);

/// Rows begin … end − 1 of a picture, and `halo` more rows on both sides; rows beyond the picture repeat its first or last row.
struct Band {
    int begin = 0, end = 0, halo = 0;

    [[nodiscard]] int rows() const { return end - begin + 2 * halo; }
    [[nodiscard]] int picture_row(int row, int height) const { return std::clamp(begin - halo + row, 0, height - 1); }
};

/// Calls work for bands that cover all rows, in parallel; the bands do not depend on the number of threads.
void for_each_band(int height, int halo, const std::function<void(const Band&)>& work);

}  // namespace subvol::detail
