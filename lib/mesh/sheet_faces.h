// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/index.h"

namespace subvol::detail {

/// A flag for each quad: whether it is a face of one of the hexahedra; for each line: whether it is an edge of one.
///
/// points: how many there are
/// cost:   O(n log n) in the quads or lines, and a pass over the hexahedra
[[nodiscard]] std::vector<std::uint8_t> are_faces(std::span<const std::array<Index, 4>> quads,
                                                  std::span<const std::array<Index, 8>> hexes, std::size_t points);
[[nodiscard]] std::vector<std::uint8_t> are_edges(std::span<const std::array<Index, 2>> lines,
                                                  std::span<const std::array<Index, 8>> hexes, std::size_t points);

}  // namespace subvol::detail
