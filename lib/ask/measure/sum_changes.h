// SPDX-License-Identifier: Apache-2.0
// What is left of sums over cells that are refined level by level, as the changes from level to level tell.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/cell.h"

namespace subvol::detail {

class Rest;
struct SampleOfChanges;

/// By how much the sums of the cells of a level differ from those of the level before: of integrals divided by the range.
///
/// size: of a cell's change. What curves up along one axis and down along another changes a sum little, although much is left.
///       The cells beside it tell: the largest change of a cell and those across its sides counts
class Changes {
    static constexpr double kMostKnown = 0.25;  // a ratio of two levels that falls no further is not one of smooth pieces
    // What follows the next level, as a part of that: at least a tenth, or more than what the changes have shrunk by.
    static constexpr double kLater = 1.5, kLeastLater = 0.1;
    static constexpr double kLeastPart = 0.05;  // of a change, that is left however little the next one is

public:
    Changes(std::size_t sums, std::size_t cells, double part)
        : follows(sums, 0), left(sums, {part, part}), part_(part), sums_(sums), changes_(sums * cells), sizes_(sums * cells) {}

    struct Left {
        double of_sum, of_spread;
    };
    /// For each sum, the part of its change that is expected to follow in the levels to come, with its sign; it is added
    std::vector<double> follows;
    /// For each sum, the part of its change that may be left after that: of what its cells sum up to with their signs, and of
    /// what does not cancel
    std::vector<Left> left;

    /// Some cells have changed by `before` at this level, and by `after` at the next one.
    ///
    /// stray: how far off a sum of `after` may be as that of a sample, in its unit; none: they are all cells
    void expect(const Rest& before, const Rest& after, std::span<const double> stray = {});
    /// The same for cells of which a sample has been refined.
    ///
    /// left_out: a flag for each cell; those that have it are none of these; none: all are
    void expect(const SampleOfChanges& sample, std::span<const std::uint8_t> left_out = {});

    /// scales: of each sum
    void note(std::size_t number, std::span<const double> changes, std::span<const double> scales) {
        for (std::size_t i = 0; i < sums_; ++i) changes_[sums_ * number + i] = static_cast<float>(changes[i] * scales[i]);
    }
    /// Forgets the changes of the sums that are not meant.
    template <class IsMeant>
    void keep(const IsMeant& is_meant) {
        for (std::size_t n = 0; n < changes_.size(); ++n) {
            if (!is_meant(n % sums_)) changes_[n] = sizes_[n] = 0;
        }
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
    double part_;
    std::size_t sums_;
    std::vector<float> changes_, sizes_;
};

struct SampleOfChanges {
    std::vector<std::uint32_t> numbers;  ///< numbers of the cells of a sample
    Changes next;                        ///< their changes at the next level, in this order
    bool is_all;                         ///< no cell is missing
};

/// What is left in the cells that are not refined further. Volumes that one cell gains are mostly lost by its neighbours, so
/// that changes are added up with their signs.
class Rest {
public:
    explicit Rest(std::size_t sums) : sums_(sums, 0), squares_(sums, 0) {}

    /// sign: 1 adds a cell, −1 takes it away
    void add(const Changes& from, std::size_t number, double sign) {
        const auto changes = from.of_cell(number), sizes = from.sizes(number);
        for (std::size_t i = 0; i < changes.size(); ++i) {
            const auto size = static_cast<double>(sizes[i]);
            sums_[i] += sign * static_cast<double>(changes[i]);
            squares_[i] += sign * size * size;
        }
    }
    /// What the changes add up to, with their signs, and what does not cancel as if it were random, twice.
    [[nodiscard]] double sum(std::size_t number) const { return sums_[number]; }
    [[nodiscard]] double spread(std::size_t number) const { return 2 * std::sqrt(std::max(0.0, squares_[number])); }
    [[nodiscard]] double change(std::size_t number) const { return std::abs(sum(number)) + spread(number); }

    /// The largest part that may be left. left: of each sum
    [[nodiscard]] double size(std::span<const Changes::Left> left) const {
        double most = 0;
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            most = std::max(most, left[i].of_sum * std::abs(sum(i)) + left[i].of_spread * spread(i));
        }
        return most;
    }

private:
    std::vector<double> sums_, squares_;
};

inline void Changes::expect(const Rest& before, const Rest& after, std::span<const double> stray) {
    for (std::size_t i = 0; i < left.size(); ++i) {
        follows[i] = 0;
        left[i] = {part_, part_};
        if (before.change(i) <= 0) continue;
        const double off = stray.empty() ? 0 : stray[i], all = (after.change(i) + off) / before.change(i),
                     ratio = before.sum(i) != 0 ? after.sum(i) / before.sum(i) : 0;
        // A sample whose cells agree on a ratio knows the next level but for what strays. The levels after it are less sure:
        // the limit of MCQ has no second derivatives, so that later ratios may be larger than the first one. What a sum of the
        // next level is by its sign may be small by chance, so what does not cancel counts, too.
        const double of_spread = before.spread(i) > 0 ? after.spread(i) / before.spread(i) : 0;
        const double later = std::clamp(kLater * of_spread, kLeastLater, 0.5);
        const bool agrees = ratio > 0 && ratio < kMostKnown && 2 * off < std::abs(after.sum(i));
        if (off > 0 && agrees) {
            follows[i] = ratio / (1 - ratio);
            left[i].of_sum = std::min(left[i].of_sum, 2 * off / std::abs(before.sum(i)) + later * ratio);
            left[i].of_spread = std::min(left[i].of_spread, 2 * off / before.spread(i) + later * of_spread);
            continue;
        }
        // Signs that cancel say nothing about what follows.
        const bool has_sign = std::abs(before.sum(i)) > before.spread(i) && ratio > 0;
        const double again = has_sign ? std::min(ratio, 0.5) : 0, part = std::max(has_sign ? all : 2 * all, kLeastPart);
        follows[i] = again / (1 - again);
        left[i] = {std::min(left[i].of_sum, part), std::min(left[i].of_spread, part)};
    }
}

/// What strays is twice the deviation of what the ratio of the sums does not explain, cell by cell.
inline void Changes::expect(const SampleOfChanges& sample, std::span<const std::uint8_t> left_out) {
    constexpr std::size_t kFewest = 8;  // of a sample that tells something about cells that are not in it
    Rest before(sums_), after(sums_);
    std::size_t count = 0;
    const auto each = [&](const auto& visit) {
        for (std::size_t n = 0; n < sample.numbers.size(); ++n) {
            if (left_out.empty() || left_out[sample.numbers[n]] == 0) visit(sample.numbers[n], n);
        }
    };
    each([&](std::size_t number, std::size_t n) {
        before.add(*this, number, 1);
        after.add(sample.next, n, 1);
        ++count;
    });
    std::vector<double> stray(sums_, 0);
    if (!sample.is_all) {
        if (count < kFewest) return expect(Rest(sums_), Rest(sums_));
        each([&](std::size_t number, std::size_t n) {
            for (std::size_t i = 0; i < sums_; ++i) {
                const double ratio = before.sum(i) != 0 ? after.sum(i) / before.sum(i) : 0;
                const double off =
                    static_cast<double>(sample.next.of_cell(n)[i]) - ratio * static_cast<double>(of_cell(number)[i]);
                stray[i] += off * off;
            }
        });
        for (double& one : stray) one = 2 * std::sqrt(one);
    }
    expect(before, after, stray);
}

}  // namespace subvol::detail
