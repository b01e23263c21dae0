// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "cut_piece.h"
#include "subvol/limit_level.h"
#include "subvol/measure.h"

namespace subvol::detail {

/// The largest value of a channel in a part of the regions, or the least.
struct RegionExtreme {
    std::optional<Index> part;  ///< none: of the whole
    std::size_t channel = 0;
    double sign = 1;          ///< 1 for the largest value, −1 for the least
    double limit = HUGE_VAL;  ///< sign × a bound that no value exceeds
    LimitExtreme best{};      ///< where the regions are known to have a value; found further
    double open = -HUGE_VAL;  ///< sign × what no place exceeds; found
    double slope = 0;         ///< by how much the value changes with the place, at the best place (value / world); found
};

/// Finds an extreme by branch and bound: boxes of pieces are halved while their bounds are above the best value by more than a
/// tolerance. The bounds hold for the pieces: the value, plus multiples of the depths behind the faces that cut the box, is a
/// polynomial that is nowhere below the value in the regions, and below its largest Bézier coefficient. The multiples are those
/// of the linear program that the box is nearly; its solution is where the best value is looked for.
///
/// tolerance: in the value's unit
/// cost: at most some thousand boxes of some 20 µs
void find_extreme(const LimitPieces& pieces, std::span<const Region> regions, std::span<const Index> groups, double tolerance,
                  RegionExtreme& extreme);

}  // namespace subvol::detail
