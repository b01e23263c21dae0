// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/topology.h"

namespace subvol::detail {

/// The points around a cell as a 4×4×4 grid: entry i + 4j + 16k is the point at (i−1, j−1, k−1) in the cell's parameters, so
/// that the cell's own corners are those with i, j, k in {1, 2}. Layers beyond a flat boundary are kNone.
using GridPoints = std::array<Index, 64>;

/// Finds the grid around a cell. False unless the cells around it are regular: as inside a box, or at its sides, edges and
/// corners.
[[nodiscard]] bool regular_grid(const Topology& topology, Index cell, GridPoints& grid);

/// The part of that grid that exists for any cell: its own corners and the points across its six sides; the others are kNone.
void cross_grid(const Topology& topology, Index cell, GridPoints& grid);

/// Whether a point looks like one of a grid: interior with 8 cells, or on a side (4 cells), an edge (2) or a corner (1) of a
/// box.
[[nodiscard]] bool is_grid_point(const Topology& topology, Index point);

}  // namespace subvol::detail
