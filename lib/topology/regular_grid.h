// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/topology.h"

namespace subvol::detail {

/// The points of a cell's surroundings as a 4×4×4 grid: entry i + 4j + 16k stands at (i−1, j−1, k−1) in the cell's parameters,
/// so that the cell's own corners are those with i, j, k in {1, 2}. Layers beyond a flat boundary are kNone.
using GridPoints = std::array<Index, 64>;

/// The grid about a cell if its surroundings are regular: inside, or at the sides, edges and corners of a box.
[[nodiscard]] bool regular_grid(const Topology& topology, Index cell, GridPoints& grid);

/// The part of that grid that any cell has: its own corners and the points across its six sides, the others kNone.
void cross_grid(const Topology& topology, Index cell, GridPoints& grid);

/// Two cells further on every side, entry i + 6j + 36k at (i−2, j−2, k−2): false unless the cell and all its neighbours are
/// inside and regular.
using WideGridPoints = std::array<Index, 216>;
[[nodiscard]] bool wide_grid(const Topology& topology, Index cell, WideGridPoints& grid);

/// Whether a point looks like one of a grid: interior with 8 cells, or on a side (4 cells), an edge (2) or a corner (1) of a
/// box.
[[nodiscard]] bool is_grid_point(const Topology& topology, Index point);

}  // namespace subvol::detail
