// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "surface_builder.h"
#include "topology_parts.h"

namespace subvol {

std::array<Index, 4> detail::outward_quad(const Topology& topology, Index cell, Index face) {
    const auto& sides = topology.cell_faces[cell];
    const auto side = static_cast<std::size_t>(std::find(sides.begin(), sides.end(), face) - sides.begin());
    std::array<Index, 4> quad;
    for (std::size_t k = 0; k < 4; ++k) quad[k] = topology.cells[cell][static_cast<std::size_t>(kCellFaces[side][k])];
    std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
    return quad;
}

Surface boundary_surface(const HexMesh& mesh) {
    return detail::boundary_surface_where(mesh, [](const auto&) { return true; });
}

Surface detail::boundary_surface_where(const HexMesh& mesh, const std::function<bool(const std::array<Index, 4>&)>& where) {
    Topology topology;  // only its faces are built
    topology.point_count = mesh.points.size();
    topology.cells = mesh.cells;
    detail::build_faces(topology);
    SurfaceBuilder builder(mesh.points.size());
    for (std::size_t f = 0; f < topology.faces.size(); ++f) {
        const auto face = static_cast<Index>(f);
        if (!topology.face_on_hull(face) || !where(topology.faces[f])) continue;
        builder.add(outward_quad(topology, topology.face_cells[f][0], face));
    }
    return builder.finish([&](Index p) { return mesh.points[p]; });
}

}  // namespace subvol
