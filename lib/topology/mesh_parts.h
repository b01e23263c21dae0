// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "subvol/topology.h"

namespace subvol::detail {

/// Some points of a mesh with all the cells about them. Whatever has one of these points, an edge, a face, a cell, is in the
/// part's topology as in that of the mesh, and in the same order.
///
/// points: the number of each point of the part in the mesh, ascending
/// own:    a flag a point: whether all the cells about it are there
struct MeshPart {
    Topology topology;
    std::vector<Index> points;
    std::vector<std::uint8_t> own;
};

/// Calls visit(part) for the parts of a mesh, slabs of up to a million points: each used point is one part's own. So never is
/// the topology of all in memory.
///
/// mesh:   must be valid
/// throws: as `build_topology` of the mesh
/// cost:   that of the topology, and what neighbouring slabs have in common; memory: 8 bytes a cell and that of a part, which
///         is a sixteenth of a small mesh
void each_part(const HexMesh& mesh, const std::function<void(const MeshPart&)>& visit);

}  // namespace subvol::detail
