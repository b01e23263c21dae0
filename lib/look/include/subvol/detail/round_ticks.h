// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/color_scale.h"

namespace subvol::detail {

/// A round value on an axis and its text, with as many digits as the step between ticks needs.
struct Tick {
    double value;
    std::string label;
};

/// Multiples of 1, 2 or 5 times a power of ten in [min, max]: at most `most`, and at least two. If the range is so narrow that
/// it has only a few numbers, the ticks are its ends, with all digits.
///
/// min, max: finite, min < max; most: 5 or more
[[nodiscard]] std::vector<Tick> round_ticks(double min, double max, int most = 7);

/// Ticks of a colour bar: of a linear scale as `round_ticks`; powers of ten on logarithmic ones, with twice and five times
/// these if there are few; ends of bands, all or every second or third, if there are not many.
[[nodiscard]] std::vector<Tick> bar_ticks(const ColorShape& shape, double min, double max, int most = 7);

/// The labels of ticks in another format, as of `LegendOptions::format`; empty: unchanged.
[[nodiscard]] std::vector<Tick> formatted(std::vector<Tick> ticks, const std::string& format);

}  // namespace subvol::detail
