// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace subvol::detail {

/// How a point moves: with the cells around it, with the faces of the boundary, with its two crease edges, or not at all.
enum class PointKind : std::uint8_t { Interior, Smooth, Crease, Corner };

}  // namespace subvol::detail
