// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace subvol::detail {

/// The largest pictures: pixels a side, and in all, which are 4 GB as float RGBA.
inline constexpr int kMostSide = 65536;
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;

}  // namespace subvol::detail
