// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>

#include "subvol/cell.h"

namespace subvol::detail {

/// A face of a cell: its points from the smallest on, in the direction of the smaller neighbour. Two cells of one hand see the
/// face that they share from two sides, so one of them has it reversed.
struct HandedFace {
    std::array<Index, 4> points;
    Index cell;
    bool reversed;  ///< against the order that is outward for a right-handed cell

    /// side: as kCellFaces
    HandedFace(const std::array<Index, 8>& corners, Index number, std::size_t side) : points{}, cell(number) {
        for (std::size_t k = 0; k < 4; ++k) points[k] = corners[static_cast<std::size_t>(kCellFaces[side][k])];
        std::rotate(points.begin(), std::ranges::min_element(points), points.end());
        reversed = points[1] > points[3];
        if (reversed) std::swap(points[1], points[3]);
    }
    HandedFace() = default;

    /// The faces of one place, then the smaller cell.
    auto operator<=>(const HandedFace&) const = default;
};

}  // namespace subvol::detail
