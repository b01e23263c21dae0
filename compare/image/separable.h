// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

namespace subvol::detail {

/// Weights of a filter at −r … r; an odd number of them.
using Taps = std::vector<double>;

/// Rows of numbers.
struct Plane {
    int width = 0;
    int height = 0;
    std::vector<double> values;

    Plane() = default;
    Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

    [[nodiscard]] double* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
    [[nodiscard]] const double* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

/// Filters rows with `across`, beyond their ends their last values, then columns with `down`. The first and last `halo` rows of
/// the plane are only read: what comes back has 2 · halo rows less.
///
/// halo: at least the radius of `down`
[[nodiscard]] Plane convolved(const Plane& plane, const Taps& across, const Taps& down, int halo);

/// σ in pixels; the sum is 1.
[[nodiscard]] Taps gaussian_taps(double sigma, int radius);

/// Rows begin … end − 1 of a picture; with a halo, rows begin − halo … end − 1 + halo, of which those beyond the picture repeat
/// its first and last.
struct Band {
    int begin = 0, end = 0, halo = 0;

    [[nodiscard]] int rows() const { return end - begin + 2 * halo; }
    [[nodiscard]] int picture_row(int row, int height) const { return std::clamp(begin - halo + row, 0, height - 1); }
};

/// Calls work for bands that together are all rows, in parallel; the bands do not depend on the number of threads.
void for_each_band(int height, int halo, const std::function<void(const Band&)>& work);

}  // namespace subvol::detail
