#pragma once

#include <functional>

#include "subvol/refine.h"
#include "subvol/surface.h"

namespace subvol::detail {

/// The boundary of the mesh's first refinement, without refining what lies inside. The scheme must interpolate.
[[nodiscard]] Surface boundary_of_child(const HexMesh& mesh, const Topology& topology, const RefineOptions& options);

/// The same, with the topology of nothing but the cells at the boundary. on_hull: a flag for each point of the mesh
[[nodiscard]] Surface boundary_of_child(const HexMesh& mesh, std::span<const std::uint8_t> on_hull,
                                        const RefineOptions& options);

/// The boundary of the mesh refined options.levels times, on the limit, refining only what lies at the boundary.
///
/// cost: about 20 points for each of the boundary's
[[nodiscard]] Surface boundary_at_level(HexMesh mesh, const RefineOptions& options);

/// As `boundary_surface`, of those faces only that `where` takes.
[[nodiscard]] Surface boundary_surface_where(const HexMesh& mesh,
                                             const std::function<bool(const std::array<Index, 4>&)>& where);

}  // namespace subvol::detail
