// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "subvol/error.h"

namespace subvol::detail {

struct KnotRange {
    double min, max;

    [[nodiscard]] double at(double t) const { return min + t * (max - min); }
};

/// The range to spread colours over. A constant field has no such range: it gets one of width 1 with the constant in the
/// middle.
///
/// throws: Error(InvalidInput) if the range is not finite or min > max
inline KnotRange usable_range(double min, double max) {
    if (!std::isfinite(min) || !std::isfinite(max) || min > max || !std::isfinite(max - min)) {
        throw Error(ErrorCode::InvalidInput, "the field's range is not finite or its minimum is above its maximum",
                    "transfer function");
    }
    constexpr double kNarrow = 1e-12;  // relative: in a narrower range neighbouring knots would round to the same value
    const double magnitude = std::max({std::abs(min), std::abs(max), 1e-300});
    if (max - min > kNarrow * magnitude) return {min, max};
    const double half = std::max(0.5, magnitude * kNarrow);
    return {min - half, max + half};
}

/// Moves two knots with the same value, which mean a jump, a billionth of the range apart. Of more than two at one value only
/// the first and the last are kept. Descending values and a range of zero width are left as they are: `validate` refuses them.
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

/// The value of the piecewise linear function through knots, which is constant beyond them. number(knot): its value at a knot
template <class Knot, class Number>
auto interpolated(const std::vector<Knot>& knots, double value, const Number& number) {
    const auto next =
        std::upper_bound(knots.begin(), knots.end(), value, [](double v, const Knot& knot) { return v < knot.value; });
    if (next == knots.begin()) return number(*next);
    const auto last = std::prev(next);
    if (next == knots.end()) return number(*last);
    const double s = (value - last->value) / (next->value - last->value);
    return (1 - s) * number(*last) + s * number(*next);
}

}  // namespace subvol::detail
