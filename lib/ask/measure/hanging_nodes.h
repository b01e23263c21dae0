// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "subvol/dense_cells.h"

namespace subvol::detail {

/// The levels of the cells beside a cell.
struct LevelsBeside {
    std::array<std::uint8_t, 6> sides{};   ///< as kCellFaces
    std::array<std::uint8_t, 12> edges{};  ///< as kCellEdges
};

/// Where cells beside a cell are coarser, moves the nodes that they share on to their quadratic pieces, so that neither a gap
/// nor an overlap is left between cells of different levels:
///
///     coarse │ fine      ●   nodes of both
///            ●           ○   of the fine cell alone: on to the parabola through three ●
///            ○
///            ●
///
/// grid:   of the cell, at `level`
/// points: its nodes, changed
void close_gaps(const DenseCell& grid, int level, const LevelsBeside& beside, std::vector<Vec3>& points);

}  // namespace subvol::detail
