// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "subvol/vec.h"

namespace subvol::detail {

/// The length that tolerances of positions are parts of: the box's diagonal, but no more than that of 1024 of the largest
/// cells, so that two bodies that are far from each other are as exact as each alone.
///
/// cell: the diagonal of the largest cell's box; 0: not known
[[nodiscard]] inline double tolerance_length(const Box& box, double cell) {
    constexpr double kCells = 1024;
    return cell > 0 ? std::min(box.diagonal(), kCells * cell) : box.diagonal();
}

}  // namespace subvol::detail
