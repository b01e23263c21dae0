// SPDX-License-Identifier: Apache-2.0
#include "separable.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numeric>

namespace subvol::detail {

namespace {

constexpr int kBandRows = 64;

int radius_of(const Taps& taps) {
    return static_cast<int>(taps.size() / 2);
}

// sums[x] += weight · values[x]: one tap for a whole row, which compilers vectorise.
void add_row(double* sums, const double* values, double weight, int count) {
    for (int x = 0; x < count; ++x) sums[x] += weight * values[x];
}

}  // namespace

Plane convolved(const Plane& plane, const Taps& across, const Taps& down, int halo) {
    const int width = plane.width, reach = radius_of(across);
    Plane rows(width, plane.height);
    std::vector<double> extended(static_cast<std::size_t>(width + 2 * reach));
    for (int y = 0; y < plane.height; ++y) {
        const double* in = plane.row(y);
        std::fill_n(extended.begin(), reach, in[0]);
        std::copy_n(in, width, extended.begin() + reach);
        std::fill_n(extended.begin() + reach + width, reach, in[width - 1]);
        for (std::size_t k = 0; k < across.size(); ++k) add_row(rows.row(y), extended.data() + k, across[k], width);
    }
    Plane result(width, plane.height - 2 * halo);
    const int first = halo - radius_of(down);
    for (int y = 0; y < result.height; ++y) {
        for (std::size_t k = 0; k < down.size(); ++k) {
            add_row(result.row(y), rows.row(y + first + static_cast<int>(k)), down[k], width);
        }
    }
    return result;
}

Taps gaussian_taps(double sigma, int radius) {
    Taps taps;
    for (int x = -radius; x <= radius; ++x) taps.push_back(std::exp(-0.5 * x * x / (sigma * sigma)));
    const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
    for (double& tap : taps) tap /= sum;
    return taps;
}

void for_each_band(int height, int halo, const std::function<void(const Band&)>& work) {
    const int bands = (height + kBandRows - 1) / kBandRows;
    tbb::parallel_for(0, bands, [&](int band) {
        const int begin = band * kBandRows;
        work({begin, std::min(begin + kBandRows, height), halo});
    });
}

}  // namespace subvol::detail
