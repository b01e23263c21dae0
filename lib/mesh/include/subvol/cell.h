// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "subvol/index.h"

namespace subvol {

/// Corner numbers of a cell's 12 edges: 4 along u, 4 along v, 4 along w; each from its lower to its upper parameter.
inline constexpr std::array<std::array<std::size_t, 2>, 12> kCellEdges{
    {{0, 1}, {3, 2}, {4, 5}, {7, 6}, {0, 3}, {1, 2}, {4, 7}, {5, 6}, {0, 4}, {1, 5}, {3, 7}, {2, 6}}};

/// Corner numbers of a cell's 6 faces (u=0, u=1, v=0, v=1, w=0, w=1), cyclic, seen counter-clockwise from outside.
inline constexpr std::array<std::array<std::size_t, 4>, 6> kCellFaces{
    {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};

/// Parameters (u, v, w) of a cell's 8 corners.
inline constexpr std::array<std::array<int, 3>, 8> kCornerParameters{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

/// Exchanges a corner's number and its octant u + 2v + 4w: the map is its own inverse.
inline constexpr std::array<std::size_t, 8> kCornerOctants{0, 1, 3, 2, 4, 5, 7, 6};

/// The three corners that share an edge with each corner, ordered so that the edges to them are right-handed.
inline constexpr std::array<std::array<std::size_t, 3>, 8> kCornerNeighbors{
    {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}}};

/// Splits a cell into 6 tetrahedra about its smallest-id corner: the three faces away from that corner take the diagonal of
/// their own smallest id, so neighbours agree on any mesh. Tetrahedra are positively oriented where the cell is.
///
/// returns: 6 × 4 point ids
[[nodiscard]] std::array<std::array<Index, 4>, 6> split_cell(const std::array<Index, 8>& cell);

}  // namespace subvol
