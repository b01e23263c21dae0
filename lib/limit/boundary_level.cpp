// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "boundary_of_child.h"
#include "subvol/limit.h"
#include "subvol/topology.h"
#include "surface_builder.h"
#include "topology_parts.h"

namespace subvol::detail {

namespace {

// Schemes make the boundary of the boundary alone. So it is enough to refine the cells about it: theirs is all that a rule of
// the boundary looks at. What else bounds these cells is none of it; a mark at the points tells which is which: 1 on the
// boundary. No point of a boundary's face is made of others, and no point of the cut's faces is made of the boundary's.

bool marked(const HexMesh& mesh, const std::array<Index, 4>& face) {
    const auto& marks = mesh.attributes.front().values;
    return std::ranges::all_of(face, [&](Index p) { return marks[p] > .5; });
}

/// 1 at the points of marked faces that bound the mesh, else 0.
std::vector<double> marks_of(const HexMesh& mesh) {
    Topology topology;  // of its faces only
    topology.point_count = mesh.points.size();
    topology.cells = mesh.cells;
    build_faces(topology);
    std::vector<double> marks(mesh.points.size(), 0);
    for (std::size_t f = 0; f < topology.faces.size(); ++f) {
        if (!topology.face_on_hull(static_cast<Index>(f)) || !marked(mesh, topology.faces[f])) continue;
        for (const Index p : topology.faces[f]) marks[p] = 1;
    }
    return marks;
}

/// The cells with a point on the marked boundary, newly marked.
HexMesh cells_about_boundary(HexMesh mesh) {
    mesh.attributes.front().values = marks_of(mesh);
    const auto& marks = mesh.attributes.front().values;
    std::erase_if(mesh.cells,
                  [&](const auto& cell) { return std::ranges::none_of(cell, [&](Index p) { return marks[p] > 0; }); });
    return without_unused_points(std::move(mesh));
}

}  // namespace

Surface boundary_at_level(HexMesh mesh, const RefineOptions& options) {
    RefineOptions once = options;
    once.levels = 1;
    mesh.attributes = {{"boundary", 1, std::vector<double>(mesh.points.size(), 1)}};
    for (int level = 0; level < options.levels; ++level) mesh = refine(cells_about_boundary(std::move(mesh)), once);
    mesh = on_limit(std::move(mesh), options.scheme.kind);
    return boundary_surface_where(mesh, [&](const auto& face) { return marked(mesh, face); });
}

}  // namespace subvol::detail
