// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "subvol/index.h"

namespace subvol::detail {

/// The number of a cell's corner at a point.
inline std::size_t corner_of(const std::array<Index, 8>& cell, Index point) {
    return static_cast<std::size_t>(std::find(cell.begin(), cell.end(), point) - cell.begin());
}

}  // namespace subvol::detail
