// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/mcq_grid.h"

#include <algorithm>

namespace subvol::detail {

namespace {

constexpr std::array<int, 3> kStride{1, 6, 36};

/// Where a term lies along an axis: at the ends of the segment that the new point halves (or at its coordinate), one step
/// beside it, or one step beyond the segment.
enum class Reach : std::uint8_t { Here, Aside, Beyond };

/// Offsets of the points that lie so along the three axes. half: the axes along which the new point lies between old ones
std::vector<std::int16_t> offsets_of(const std::array<Reach, 3>& reach, std::size_t half) {
    std::vector<int> sums{0};
    for (std::size_t a = 0; a < 3; ++a) {
        const bool between = half >> a & 1;
        const std::vector<int> steps = reach[a] == Reach::Here    ? (between ? std::vector{0, 1} : std::vector{0})
                                       : reach[a] == Reach::Aside ? std::vector{-1, 1}
                                                                  : std::vector{-1, 2};
        std::vector<int> next;
        for (const int sum : sums) {
            for (const int step : steps) next.push_back(sum + step * kStride[a]);
        }
        sums = std::move(next);
    }
    return {sums.begin(), sums.end()};
}

}  // namespace

McqGrid::McqGrid(double omega) {
    constexpr std::array<Reach, 3> kHere{Reach::Here, Reach::Here, Reach::Here};
    for (std::size_t half = 0; half < 8; ++half) {
        const auto count = static_cast<double>((half & 1) + (half >> 1 & 1) + (half >> 2));
        auto& mask = masks_[half];
        const auto add = [&](const std::array<Reach, 3>& reach, double weight) {
            mask.push_back({weight, offsets_of(reach, half)});
        };
        const auto with = [](std::array<Reach, 3> reach, std::size_t axis, Reach r) {
            reach[axis] = r;
            return reach;
        };
        const double corner = count == 0 ? 1 : count == 1 ? 0.5 : count == 2 ? (1 + 2 * omega) / 4 : (1 + 6 * omega) / 8;
        add(kHere, corner);
        if (count == 0) continue;
        for (std::size_t a = 0; a < 3; ++a) {
            const bool between = half >> a & 1;
            if (!between) {
                add(with(kHere, a, Reach::Aside), omega / 4);  // over and under the edge or face
            } else if (count > 1) {
                add(with(kHere, a, Reach::Beyond), -omega / 4);  // beyond, in the plane of the face or from the cell
            }
            for (std::size_t b = 0; between && b < 3; ++b) {
                if (half >> b & 1) continue;
                const double weight = count == 1 ? -omega / 4 : -omega / 8;
                add(with(with(kHere, a, Reach::Beyond), b, Reach::Aside), weight);
            }
        }
    }
}

void McqGrid::refine(std::size_t octant, std::size_t channels, std::span<const double> from, std::span<double> to) const {
    // Along an axis the child's points have half the spacing: they start at −1 in a lower child, at −1/2 in an upper one.
    const auto halves = [&](std::size_t axis, std::size_t i) { return i + 2 + (octant >> axis & 1); };
    for (std::size_t n = 0; n < kPoints; ++n) {
        const std::array<std::size_t, 3> at{halves(0, n % 6), halves(1, n / 6 % 6), halves(2, n / 36)};
        const std::size_t base = at[0] / 2 + 6 * (at[1] / 2) + 36 * (at[2] / 2);
        double* value = &to[n * channels];
        std::fill_n(value, channels, 0.0);
        for (const auto& [weight, offsets] : masks_[(at[0] & 1) + 2 * (at[1] & 1) + 4 * (at[2] & 1)]) {
            for (const int offset : offsets) {
                const double* term = &from[static_cast<std::size_t>(static_cast<int>(base) + offset) * channels];
                for (std::size_t c = 0; c < channels; ++c) value[c] += weight * term[c];
            }
        }
    }
}

}  // namespace subvol::detail
