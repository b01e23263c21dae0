// SPDX-License-Identifier: Apache-2.0
#include "separable.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numeric>

namespace subvol::detail {

namespace {

constexpr std::size_t kBandRows = 64;

// sums[x] += weight · values[x]: one tap for a whole row, which compilers vectorise.
void add_row(std::span<double> sums, const double* values, double weight) {
    for (std::size_t x = 0; x < sums.size(); ++x) sums[x] += weight * values[x];
}

}  // namespace

Plane convolved(const Plane& plane, const Taps& across, const Taps& down, std::size_t halo) {
    const std::size_t width = plane.width, reach = across.size() / 2;
    Plane rows(width, plane.height);
    std::vector<double> extended(width + 2 * reach);
    for (std::size_t y = 0; y < plane.height; ++y) {
        const std::span<const double> row = plane.row(y);
        std::fill_n(std::copy_n(row.begin(), width, std::fill_n(extended.begin(), reach, row.front())), reach, row.back());
        for (std::size_t k = 0; k < across.size(); ++k) add_row(rows.row(y), extended.data() + k, across[k]);
    }
    Plane result(width, plane.height - 2 * halo);
    const std::size_t first = halo - down.size() / 2;
    for (std::size_t y = 0; y < result.height; ++y) {
        for (std::size_t k = 0; k < down.size(); ++k) add_row(result.row(y), rows.row(y + first + k).data(), down[k]);
    }
    return result;
}

Taps gaussian_taps(double sigma, std::size_t radius) {
    Taps taps;
    double x = -static_cast<double>(radius);
    while (taps.size() < 2 * radius + 1) {
        taps.push_back(std::exp(-0.5 * x * x / (sigma * sigma)));
        ++x;
    }
    const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
    for (double& tap : taps) tap /= sum;
    return taps;
}

void for_each_band(std::size_t height, std::size_t halo, const std::function<void(const Band&)>& work) {
    const std::size_t bands = (height + kBandRows - 1) / kBandRows;
    tbb::parallel_for(std::size_t{0}, bands, [&](std::size_t band) {
        const std::size_t begin = band * kBandRows;
        work({begin, std::min(begin + kBandRows, height), halo, height});
    });
}

}  // namespace subvol::detail
