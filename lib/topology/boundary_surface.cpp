// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "surface_builder.h"
#include "topology_parts.h"

namespace subvol {

std::array<Index, 4> detail::outward_quad(const Topology& topology, Index cell, Index face) {
    const auto& sides = topology.cell_faces[cell];
    return outward_quad(topology.cells[cell],
                        static_cast<std::size_t>(std::find(sides.begin(), sides.end(), face) - sides.begin()));
}

Surface boundary_surface(const HexMesh& mesh) {
    return detail::boundary_surface_where(mesh, [](const auto&) { return true; });
}

Surface detail::boundary_surface_where(const HexMesh& mesh, const std::function<bool(const std::array<Index, 4>&)>& where) {
    SurfaceBuilder builder(mesh.points.size());
    for (const auto& quad : hull_quads(mesh, where)) builder.add(quad);
    return builder.finish([&](Index p) { return mesh.points[p]; });
}

}  // namespace subvol
