// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "subvol/share.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// A part of a mesh: some points, which it owns, with all cells that use them. Every edge, face and cell with one of these
/// points is in the part's topology as in the topology of the mesh, and in the same order.
struct MeshPart {
    Topology topology;
    std::vector<Index> points;      ///< the number in the mesh of each point of the part, ascending
    std::vector<std::uint8_t> own;  ///< a flag for each point: whether the part owns it and so has all its cells
};

/// Calls visit(part) for the parts of a mesh, slabs of up to a million points: each used point is owned by one part. The
/// topology of the whole mesh is never in memory.
///
/// mesh:   must be valid
/// throws: as `build_topology` of the mesh
/// cost:   that of the topology, plus what neighbouring slabs have in common; memory: 8 bytes per cell and that of a part, a
///         sixteenth of a small mesh
void each_part(const HexMesh& mesh, const std::function<void(const MeshPart&)>& visit);

/// The parts of one of several shares: those of all shares together are those of the whole.
void each_part(const HexMesh& mesh, const Share& share, const std::function<void(const MeshPart&)>& visit);

}  // namespace subvol::detail
