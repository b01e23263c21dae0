// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/refine.h"
#include "subvol/surface.h"

namespace subvol::detail {

/// The boundary of the mesh's first refinement, without refining the interior. The scheme must interpolate.
[[nodiscard]] Surface boundary_of_child(const HexMesh& mesh, const Topology& topology, const SchemeOptions& scheme);

/// The same; builds the topology of the cells at the boundary only. on_hull: a flag for each point of the mesh
[[nodiscard]] Surface boundary_of_child(const HexMesh& mesh, std::span<const std::uint8_t> on_hull,
                                        const SchemeOptions& scheme);

/// The boundary of the mesh refined options.levels times, on the limit; refines only the cells at the boundary.
///
/// mesh: valid, with its creases; options.scheme.crease_angle_deg is not used
/// cost: about 20 points for each point of the boundary
[[nodiscard]] Surface boundary_at_level(HexMesh mesh, const RefineOptions& options);

}  // namespace subvol::detail
