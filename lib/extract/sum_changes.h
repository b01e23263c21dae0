// SPDX-License-Identifier: Apache-2.0
// What is left of sums over cells that are refined level by level, as the changes from level to level tell.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "subvol/cell.h"

namespace subvol::detail {

/// By how much the sums of the cells of a level differ from those of the level before: of integrals divided by the range.
///
/// left: of each sum, the part of its change that is expected to be left
/// size: of a cell's change. What curves up along one axis and down along another changes a sum little, although much is left.
///       The cells beside it tell: the largest change of a cell and those across its sides counts
class Changes {
public:
    Changes(std::size_t sums, std::size_t cells, double part)
        : left(sums, part), sums_(sums), changes_(sums * cells), sizes_(sums * cells) {}

    std::vector<double> left;

    /// scales: of each sum
    void note(std::size_t number, std::span<const double> changes, std::span<const double> scales) {
        for (std::size_t i = 0; i < sums_; ++i) changes_[sums_ * number + i] = static_cast<float>(changes[i] * scales[i]);
    }
    [[nodiscard]] std::span<const float> of_cell(std::size_t number) const {
        return std::span(changes_).subspan(sums_ * number, sums_);
    }
    /// beside: the numbers of the cells across the sides of each cell of the level, kNone for others
    template <class Beside>
    void compare(const Beside& beside) {
        tbb::parallel_for(std::size_t{0}, changes_.size() / sums_, [&](std::size_t number) {
            float* const sizes = &sizes_[sums_ * number];
            const auto enlarge = [&](std::size_t other) {
                for (std::size_t i = 0; i < sums_; ++i) sizes[i] = std::max(sizes[i], std::abs(changes_[sums_ * other + i]));
            };
            enlarge(number);
            for (const Index other : beside(number)) {
                if (other != kNone) enlarge(other);
            }
        });
    }
    [[nodiscard]] std::span<const float> sizes(std::size_t number) const {
        return std::span(sizes_).subspan(sums_ * number, sums_);
    }
    [[nodiscard]] float largest(std::size_t number) const { return std::ranges::max(sizes(number)); }

private:
    std::size_t sums_;
    std::vector<float> changes_, sizes_;
};

/// What is left in the cells that are not refined further. Volumes that one cell gains are mostly lost by its neighbours, so
/// that changes are added up with their signs, and what does not cancel as if it were random, twice.
class Rest {
public:
    explicit Rest(const Changes& changes) : changes_(changes), sums_(changes.of_cell(0).size(), 0), squares_(sums_.size(), 0) {}

    /// sign: 1 adds a cell, −1 takes it away
    void add(std::size_t number, double sign) {
        const auto changes = changes_.of_cell(number), sizes = changes_.sizes(number);
        for (std::size_t i = 0; i < changes.size(); ++i) {
            const auto size = static_cast<double>(sizes[i]);
            sums_[i] += sign * static_cast<double>(changes[i]);
            squares_[i] += sign * size * size;
        }
    }
    [[nodiscard]] double change(std::size_t sum) const {
        return std::abs(sums_[sum]) + 2 * std::sqrt(std::max(0.0, squares_[sum]));
    }
    [[nodiscard]] double size() const {
        double most = 0;
        for (std::size_t i = 0; i < sums_.size(); ++i) most = std::max(most, changes_.left[i] * change(i));
        return most;
    }

private:
    const Changes& changes_;
    std::vector<double> sums_, squares_;
};

}  // namespace subvol::detail
