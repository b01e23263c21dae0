// SPDX-License-Identifier: Apache-2.0
// Quads and lines without cells as a Topology, for the rules of boundaries.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "boundary_rings.h"
#include "subvol/shells.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// kinds: of the points that have an edge here
struct ShellTopology {
    Topology topology;
    std::vector<PointKind> kinds;
};

/// on_solid: whether an edge lies on an edge of a cell, by its points, the smaller first
using OnSolid = std::function<bool(Index, Index)>;

/// The quads of the shells: all are boundary faces without cells, in the order of `shells.quads`, with their points.
[[nodiscard]] ShellTopology topology_of_quads(const Shells& shells, const OnSolid& on_solid);

/// The lines that are not edges of quads: all are creases.
[[nodiscard]] ShellTopology topology_of_lines(const Shells& shells, const Topology& quads);

}  // namespace subvol::detail
