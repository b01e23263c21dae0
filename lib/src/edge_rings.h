#pragma once

#include "subvol/topology.h"

namespace subvol::detail {

/// Puts the faces of every edge into ring order and fills edge_cells and edge_has_ring.
void order_edge_rings(Topology& topology);

}  // namespace subvol::detail
