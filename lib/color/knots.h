// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace subvol::detail {

/// Makes two knots of the same value, a jump, into two that lie a billionth of the range apart; of more than two at one value
/// the first and the last count. Values that descend, or a range of no width, are left for `validate` to refuse.
template <class Knot>
void part_equal_values(std::vector<Knot>& knots) {
    std::vector<Knot> parted;
    for (const Knot& knot : knots) {
        const std::size_t n = parted.size();
        const bool third = n >= 2 && parted[n - 1].value == knot.value && parted[n - 2].value == knot.value;
        if (third) parted.pop_back();
        parted.push_back(knot);
    }
    const double range = knots.empty() ? 0 : knots.back().value - knots.front().value;
    for (std::size_t i = 1; range > 0 && i < parted.size(); ++i) {
        const double value = parted[i].value;
        if (parted[i - 1].value != value) continue;
        const auto moved = [&](double gap, double sign) {
            const double to = value + sign * std::min(1e-9 * range, 0.5 * gap);
            return to != value ? to : std::nextafter(value, sign * std::numeric_limits<double>::infinity());
        };
        if (i + 1 < parted.size()) {
            parted[i].value = moved(parted[i + 1].value - value, 1);
        } else {
            parted[i - 1].value = moved(i >= 2 ? value - parted[i - 2].value : range, -1);
        }
    }
    knots = std::move(parted);
}

/// Appends places in (from, to], the last of them `to`, between which a curve hardly differs from its chord.
///
/// is_close(a, b): whether it does so between the places a and b
template <class IsClose>
void add_chord_ends(const IsClose& is_close, double from, double to, std::vector<double>& places, int depth = 0) {
    constexpr int kMaxDepth = 14;  // a kink in between is caught to 1/16384 of the interval
    if (depth == kMaxDepth || is_close(from, to)) {
        places.push_back(to);
        return;
    }
    const double middle = 0.5 * (from + to);
    add_chord_ends(is_close, from, middle, places, depth + 1);
    add_chord_ends(is_close, middle, to, places, depth + 1);
}

/// Whether deviation(s, t), at s = a + t (b − a), stays within 1/512 between a and b. Seven places are looked at: hence the .9.
template <class Deviation>
bool deviates_little(const Deviation& deviation, double a, double b) {
    for (int i = 1; i < 8; ++i) {
        const double t = i / 8.0;
        if (!(deviation(a + t * (b - a), t) <= 0.9 / 512)) return false;
    }
    return true;
}

/// Appends the knots make(s) at begin + s · (end − begin), but for those that rounding puts on or before their neighbours.
template <class Knot, class Make>
void append_between(std::vector<Knot>& knots, const std::vector<double>& places, double begin, double end, const Make& make) {
    for (const double s : places) {
        const double value = begin + s * (end - begin);
        if (value > knots.back().value && value < end) knots.push_back({value, make(s)});
    }
}

}  // namespace subvol::detail
