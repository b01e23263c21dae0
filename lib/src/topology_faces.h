#pragma once

#include "subvol/topology.h"

namespace subvol::detail {

/// Fills faces, face_cells and cell_faces of a topology that has its cells and point_count.
///
/// throws: Error(InvalidInput) if more than two cells share a face, or two cells have the same corners
void build_faces(Topology& topology);

}  // namespace subvol::detail
