// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace subvol {

/// The number of a point, cell, edge or face. 32 bits are enough for 4 billion; the build option SUBVOL_INDEX64 makes it 64.
#ifdef SUBVOL_INDEX64
using Index = std::uint64_t;
#else
using Index = std::uint32_t;
#endif
inline constexpr Index kNone = std::numeric_limits<Index>::max();

}  // namespace subvol
