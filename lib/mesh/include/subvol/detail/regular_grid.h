// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "subvol/detail/turned_cell.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The points around a cell as a 4×4×4 grid: entry i + 4j + 16k is the point at (i−1, j−1, k−1) in the cell's parameters, so
/// that the cell's own corners are those with i, j, k in {1, 2}. Layers beyond a flat boundary are kNone.
using GridPoints = std::array<Index, 64>;

/// Finds the grid around a cell. False unless the cells around it are regular: as inside a box, or at its sides, edges and
/// corners.
[[nodiscard]] bool regular_grid(const Topology& topology, Index cell, GridPoints& grid);

/// The points around a cell as a 6×6×6 grid: entry i + 6j + 36k is the point at (i−2, j−2, k−2) in the cell's parameters.
/// Layers beyond a flat boundary are kNone.
using WidePoints = std::array<Index, 216>;

/// Finds the wider grid around a cell. False unless the cells around all points of the inner 4×4×4 are regular.
///
/// is_grid: `is_grid_point` of each point
[[nodiscard]] bool wide_grid(const Topology& topology, std::span<const std::uint8_t> is_grid, Index cell, WidePoints& grid);

/// The part of that grid that exists for any cell: its own corners and the points across its six sides; the others are kNone.
void cross_grid(const Topology& topology, Index cell, GridPoints& grid);

/// Whether a point looks like one of a grid: interior with 8 cells, or on a side (4 cells), an edge (2) or a corner (1) of a
/// box.
[[nodiscard]] bool is_grid_point(const Topology& topology, Index point);

}  // namespace subvol::detail
