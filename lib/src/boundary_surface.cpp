#include <algorithm>

#include "subvol/surface.h"
#include "topology_faces.h"

namespace subvol {

namespace {

/// The quad of a cell's side, counter-clockwise from outside, its smallest id first.
std::array<Index, 4> outward_quad(const Topology& topology, Index cell, Index face) {
    const auto& sides = topology.cell_faces[cell];
    const auto side = static_cast<std::size_t>(std::find(sides.begin(), sides.end(), face) - sides.begin());
    std::array<Index, 4> quad;
    for (std::size_t k = 0; k < 4; ++k) quad[k] = topology.cells[cell][static_cast<std::size_t>(kCellFaces[side][k])];
    std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
    return quad;
}

}  // namespace

Surface boundary_surface(const HexMesh& mesh) {
    Topology topology;  // of its faces only
    topology.point_count = mesh.points.size();
    topology.cells = mesh.cells;
    detail::build_faces(topology);
    Surface surface;
    std::vector<Index> renumbered(mesh.points.size(), kNone);
    const auto point = [&](Index p) {
        if (renumbered[p] == kNone) {
            renumbered[p] = static_cast<Index>(surface.points.size());
            surface.points.push_back(mesh.points[p]);
        }
        return renumbered[p];
    };
    for (std::size_t f = 0; f < topology.faces.size(); ++f) {
        if (!topology.face_on_hull(static_cast<Index>(f))) continue;
        const auto quad = outward_quad(topology, topology.face_cells[f][0], static_cast<Index>(f));
        const std::array<Index, 4> q{point(quad[0]), point(quad[1]), point(quad[2]), point(quad[3])};
        surface.triangles.push_back({q[0], q[1], q[2]});
        surface.triangles.push_back({q[0], q[2], q[3]});
    }
    return surface;
}

}  // namespace subvol
