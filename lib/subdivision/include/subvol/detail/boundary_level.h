// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
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

/// The boundary of the mesh's first refinement in parts, each face in one of them, so that a large mesh takes some 25 bytes a
/// cell. on_hull: as above, or empty: of the whole mesh
///
/// visit: called with one part after the other
void each_part_of_child(const HexMesh& mesh, std::span<const std::uint8_t> on_hull, const SchemeOptions& scheme,
                        const std::function<void(const Surface&)>& visit);

/// The cells at the boundary refined options.levels times, with their attributes, not moved to the limit. on_hull: of the
/// mesh's points, or empty; becomes that of the result's
[[nodiscard]] HexMesh hull_before_limit(HexMesh mesh, const RefineOptions& options, std::vector<std::uint8_t>& on_hull);

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
