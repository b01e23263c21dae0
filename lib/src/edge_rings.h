#pragma once

#include "subvol/topology.h"

namespace subvol::detail {

/// Puts the faces of every edge into ring order and fills edge_cells and edge_has_ring.
void order_edge_rings(Topology& topology);

/// The faces of one edge (ascending) walked from cell to cell: fans from hull face to hull face, then closed rings.
///
/// returns: the number of closed rings
int walk_edge_ring(const Topology& topology, std::span<const Index> edge_faces, std::vector<Index>& ring_faces,
                   std::vector<Index>& ring_cells);

}  // namespace subvol::detail
