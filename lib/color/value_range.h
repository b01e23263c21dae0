// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "subvol/error.h"

namespace subvol::detail {

struct ValueRange {
    double min, max;

    [[nodiscard]] double at(double t) const { return min + t * (max - min); }
};

/// A constant field has no range to spread colours over: it gets one of width 1, itself in the middle.
///
/// throws: Error(InvalidInput) for a range that is not finite or upside down
inline ValueRange usable_range(double min, double max) {
    if (!std::isfinite(min) || !std::isfinite(max) || min > max || !std::isfinite(max - min)) {
        throw Error(ErrorCode::InvalidInput, "the field's range is not finite or upside down", "transfer function");
    }
    constexpr double kNarrow = 1e-12;  // relative: narrower, and neighbouring knots would round to one value
    const double magnitude = std::max({std::abs(min), std::abs(max), 1e-300});
    if (max - min > kNarrow * magnitude) return {min, max};
    const double half = std::max(0.5, magnitude * kNarrow);
    return {min - half, max + half};
}

}  // namespace subvol::detail
