// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sheet_topology.h"
#include "subvol/refine_sheets.h"

namespace subvol::detail {

/// A level of sheets, and the cells about them.
///
/// solid: the cells at the sheets with some layers about them, as `refine` has them; of level 0 the whole control mesh. Without
///        points if no point is attached
/// cells: the number that each of these cells has in the whole mesh of this level; empty: the same
/// at:    for each point of the sheets its point of `solid`, or kNone
struct SheetLevel {
    Sheets sheets;
    HexMesh solid;
    std::vector<Index> cells;
    std::vector<Index> at;
};

/// The sheets refined, with the points that are attached to cells where these have them.
[[nodiscard]] SheetLevel refine_sheet_level(const HexMesh& mesh, const Sheets& sheets, const RefineOptions& options);

/// The topologies of the quads and of the other lines of a level.
struct SheetComplex {
    SheetTopology quads, lines;
};
[[nodiscard]] SheetComplex complex_of(const SheetLevel& level);

}  // namespace subvol::detail
