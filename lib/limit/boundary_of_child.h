// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/refine.h"
#include "subvol/surface.h"

namespace subvol::detail {

/// The boundary of the mesh's first refinement, without refining what lies inside. The scheme must interpolate.
[[nodiscard]] Surface boundary_of_child(const HexMesh& mesh, const Topology& topology, const SchemeOptions& scheme);

/// The same, with the topology of nothing but the cells at the boundary. on_hull: a flag for each point of the mesh
[[nodiscard]] Surface boundary_of_child(const HexMesh& mesh, std::span<const std::uint8_t> on_hull,
                                        const SchemeOptions& scheme);

/// The boundary of the mesh refined options.levels times, on the limit, refining only what lies at the boundary.
///
/// cost: about 20 points for each of the boundary's
[[nodiscard]] Surface boundary_at_level(HexMesh mesh, const RefineOptions& options);

}  // namespace subvol::detail
