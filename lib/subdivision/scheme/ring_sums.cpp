// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/ring_sums.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace subvol::detail {

namespace {

/// The cosine and the sine of member i of m.
std::array<double, 2> direction(std::size_t i, std::size_t m) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(m);
    return {std::cos(angle), std::sin(angle)};
}

}  // namespace

void RingSums::add(Center center, std::span<const Index> members, std::span<const std::vector<Index>> points) {
    const std::size_t m = members.size();
    const auto& about = points.front();
    const auto least = static_cast<std::size_t>(std::ranges::min_element(about) - about.begin());
    Ring ring{.column = columns_,
              .first = least,
              .reversed = about[(least + m - 1) % m] < about[(least + 1) % m],
              .slots = {},
              .points = {}};
    for (std::size_t j = 0; j < m; ++j) ring.slots.emplace_back(members[j], j);
    std::ranges::sort(ring.slots);
    for (const std::vector<Index>& at_end : points) {
        auto& counted = ring.points.emplace_back();
        for (std::size_t j = 0; j < m; ++j) counted.push_back(at_end[(least + (ring.reversed ? m - j : j)) % m]);
    }
    columns_ += 2 * points.size();
    numbers_.emplace(center.key(), rings_.size());
    rings_.push_back(std::move(ring));
}

std::size_t RingSums::slot(Center center, Index member) const {
    const auto& slots = ring(center).slots;
    return std::ranges::lower_bound(slots, member, {}, &std::pair<Index, std::size_t>::first)->second;
}

void RingSums::add_terms(Center center, Index member, std::size_t end, double weight, StencilBuilder& row) const {
    const Ring& about = ring(center);
    const std::size_t m = about.size(), place = slot(center, member);
    const std::size_t i = (about.reversed ? m + about.first - place : m + place - about.first) % m;
    const auto toward = direction(i, m);
    for (std::size_t k = 0; k < 2; ++k) {
        const auto column = static_cast<Index>(about.column + 2 * end + k);
        row.add(column, -4 / static_cast<double>(m) * toward[k] * weight);
    }
}

std::vector<double> RingSums::with_sums(const double* values, std::size_t channels) const {
    const std::size_t points = rings_.front().column;
    std::vector<double> all(columns_ * channels);
    std::copy_n(values, points * channels, all.begin());
    for (const Ring& ring : rings_) {
        const std::size_t m = ring.size();
        for (std::size_t end = 0; end < ring.points.size(); ++end) {
            double* const sums = &all[(ring.column + 2 * end) * channels];
            const double* const origin = values + ring.points[end][0] * channels;
            for (std::size_t j = 1; j < m; ++j) {
                const auto toward = direction(j, m);
                const double* const from = values + ring.points[end][j] * channels;
                // The cosines add up to 0, and so do the sines: differences lose no digits far from the origin.
                for (std::size_t k = 0; k < 2; ++k) {
                    for (std::size_t c = 0; c < channels; ++c) sums[k * channels + c] += toward[k] * (from[c] - origin[c]);
                }
            }
        }
    }
    return all;
}

}  // namespace subvol::detail
