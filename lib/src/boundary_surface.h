#pragma once

#include "subvol/refine.h"
#include "subvol/surface.h"

namespace subvol::detail {

/// The boundary of the mesh's first refinement, without refining what lies inside. The scheme must interpolate.
[[nodiscard]] Surface boundary_of_child(const HexMesh& mesh, const Topology& topology, const RefineOptions& options);

}  // namespace subvol::detail
