// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shell_topology.h"
#include "subvol/refine_shells.h"

namespace subvol::detail {

/// A level of shells, and the cells about them.
///
/// solid: the cells at the shells with some layers about them, as `refine` has them; of level 0 the whole control mesh. Without
///        points if no point is attached
/// cells: the number that each of these cells has in the whole mesh of this level; empty: the same
/// at:    for each point of the shells its point of `solid`, or kNone
struct ShellLevel {
    Shells shells;
    HexMesh solid;
    std::vector<Index> cells;
    std::vector<Index> at;
};

/// The shells refined, with the points that are attached to cells where these have them.
[[nodiscard]] ShellLevel refine_shell_level(const HexMesh& mesh, const Shells& shells, const RefineOptions& options);

/// The topologies of the quads and of the other lines of a level.
struct ShellComplex {
    ShellTopology quads, lines;
};
[[nodiscard]] ShellComplex complex_of(const ShellLevel& level);

}  // namespace subvol::detail
