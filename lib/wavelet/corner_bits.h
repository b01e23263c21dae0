// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace subvol::detail {

using CornerNumber = std::uint8_t;

/// Corners as numbers with a bit for each axis, and back: the same map.
constexpr std::size_t swapped(std::size_t corner) {
    return corner ^ ((corner >> 1) & 1);
}
constexpr std::size_t flip(std::size_t corner, std::size_t axis) {
    return swapped(swapped(corner) ^ (std::size_t{1} << axis));
}
constexpr std::size_t across(std::size_t corner) {
    return swapped(swapped(corner) ^ 7);
}
constexpr std::size_t side_of(std::size_t corner, std::size_t axis) {
    return swapped(corner) >> axis & 1;
}

}  // namespace subvol::detail
