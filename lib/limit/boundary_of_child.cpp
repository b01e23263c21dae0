// SPDX-License-Identifier: Apache-2.0
#include "boundary_of_child.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "boundary_rings.h"
#include "scheme_rows.h"
#include "surface_builder.h"

namespace subvol::detail {

namespace {

using FaceTest = std::function<bool(const std::array<Index, 4>&)>;

Surface boundary_of_child_where(const HexMesh& mesh, const Topology& topology, const SchemeOptions& scheme,
                                const FaceTest& where) {
    const SchemeRows rows(topology, scheme);
    const ChildNumbering first(topology);
    SurfaceBuilder builder(first.cells);  // no cell point is on the boundary
    for (std::size_t f = 0; f < topology.faces.size(); ++f) {
        const auto face = static_cast<Index>(f);
        if (!topology.face_on_hull(face) || !where(topology.faces[f])) continue;
        const auto quad = outward_quad(topology, topology.face_cells[f][0], face);
        const auto center = static_cast<Index>(first.faces + f);
        const auto edge_point = [&](std::size_t k) {  // between corners k and k + 1
            const std::size_t a = slot_of(topology.faces[f], quad[k]), b = slot_of(topology.faces[f], quad[(k + 1) % 4]);
            return static_cast<Index>(first.edges + topology.face_edges[f][(a + 1) % 4 == b ? a : b]);
        };
        for (std::size_t k = 0; k < 4; ++k) builder.add({quad[k], edge_point(k), center, edge_point((k + 3) % 4)});
    }
    tbb::enumerable_thread_specific<StencilBuilder> scratch;
    return builder.finish([&](Index p) {
        if (p < rows.kept()) return mesh.points[p];
        StencilBuilder& row = scratch.local();
        row.clear();
        rows.write_row(p, row);
        const StencilRuns stencil = row.finish();
        Vec3 position(0.0);
        std::size_t next = 0;
        for (const auto& [weight, count] : stencil.runs) {
            Vec3 sum(0.0);
            for (std::uint32_t i = 0; i < count; ++i) sum += mesh.points[stencil.points[next++]];
            position += weight * sum;
        }
        return position;
    });
}

}  // namespace

Surface boundary_of_child(const HexMesh& mesh, const Topology& topology, const SchemeOptions& scheme) {
    return boundary_of_child_where(mesh, topology, scheme, [](const auto&) { return true; });
}

// The cut's faces, too, have a cell on one side only; none of them has a point on the hull.
Surface boundary_of_child(const HexMesh& mesh, std::span<const std::uint8_t> on_hull, const SchemeOptions& scheme) {
    const auto at_hull = [&](const auto& entity) { return std::ranges::any_of(entity, [&](Index p) { return on_hull[p]; }); };
    HexMesh near;
    near.points = mesh.points;
    near.attributes = {{"hull", 1, {on_hull.begin(), on_hull.end()}}};
    near.creases = mesh.creases;
    std::ranges::copy_if(mesh.cells, std::back_inserter(near.cells), at_hull);
    std::ranges::copy_if(mesh.sharp_faces, std::back_inserter(near.sharp_faces), at_hull);
    near = without_unused_points(std::move(near));
    const auto& hull = near.attributes.front().values;
    return boundary_of_child_where(near, build_topology(near), scheme, [&](const auto& face) { return hull[face[0]] > 0; });
}

}  // namespace subvol::detail
