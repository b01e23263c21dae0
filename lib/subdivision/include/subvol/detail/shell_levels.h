// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "subvol/detail/boundary_rings.h"
#include "subvol/refine_shells.h"
#include "subvol/shells.h"
#include "subvol/topology.h"

namespace subvol::detail {

struct ShellTopology {
    Topology topology;
    std::vector<PointKind> kinds;  ///< kinds of the points that have an edge here
};

/// on_solid: whether an edge lies on an edge of a cell, by its points, the smaller first
using OnSolid = std::function<bool(Index, Index)>;

/// The quads of the shells: all are boundary faces without cells, in the order of `shells.quads`, with their points.
[[nodiscard]] ShellTopology topology_of_quads(const Shells& shells, const OnSolid& on_solid);

/// The lines that are not edges of quads: all are creases.
[[nodiscard]] ShellTopology topology_of_lines(const Shells& shells, const Topology& quads);

/// A level of shells, and the cells about them.
struct ShellLevel {
    Shells shells;
    /// The cells at the shells with some layers about them, as `refine` has them; of level 0 the whole control mesh. Without
    /// points if no point is attached
    HexMesh solid;
    std::vector<Index> cells;  ///< the number that each of these cells has in the whole mesh of this level; empty: the same
    std::vector<Index> at;     ///< for each point of the shells its point of `solid`, or kNone
};

/// The shells refined, with the points that are attached to cells where these have them.
[[nodiscard]] ShellLevel refine_shell_level(const HexMesh& mesh, const Shells& shells, const RefineOptions& options);

/// The topologies of the quads and of the other lines of a level.
struct ShellComplex {
    ShellTopology quads, lines;
};
[[nodiscard]] ShellComplex complex_of(const ShellLevel& level);

}  // namespace subvol::detail
