#pragma once

#include <array>

namespace subvol::detail {

/// (u, v, w) of the corners of a cell in VTK order.
inline constexpr std::array<std::array<int, 3>, 8> kCornerParameters{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

}  // namespace subvol::detail
