// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "subvol/boundary_values.h"
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

/// The same for a mesh that may be a part of another one, as long as it has all cells at the other's hull. on_hull: a flag for
/// each point of the mesh
[[nodiscard]] Surface boundary_at_level(HexMesh mesh, std::vector<std::uint8_t> on_hull, const RefineOptions& options);

/// `levels`, or fewer if a boundary of so many triangles would get more than eight million: they are finer than any picture.
[[nodiscard]] int sensible_levels(std::size_t triangles, int levels);

}  // namespace subvol::detail
