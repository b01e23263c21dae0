#include "boundary_surface.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "boundary_rings.h"
#include "bucket_sort.h"
#include "scheme_rows.h"
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

/// A surface's triangles and, in the order of their first use, the points of the mesh that they need.
class SurfaceBuilder {
public:
    explicit SurfaceBuilder(std::size_t mesh_points) : renumbered_(mesh_points, kNone) {}

    /// The quad's smallest id comes first.
    void add(const std::array<Index, 4>& quad) {
        const std::array<Index, 4> q{number(quad[0]), number(quad[1]), number(quad[2]), number(quad[3])};
        triangles_.push_back({q[0], q[1], q[2]});
        triangles_.push_back({q[0], q[2], q[3]});
    }

    /// position(point of the mesh) is called in parallel.
    template <class Position>
    Surface finish(const Position& position) {
        Surface surface{std::vector<Vec3>(used_.size()), std::move(triangles_)};
        detail::parallel_each(used_.size(), [&](std::size_t i) { surface.points[i] = position(used_[i]); });
        return surface;
    }

private:
    Index number(Index p) {
        if (renumbered_[p] == kNone) {
            renumbered_[p] = static_cast<Index>(used_.size());
            used_.push_back(p);
        }
        return renumbered_[p];
    }

    std::vector<Index> renumbered_, used_;
    std::vector<std::array<Index, 3>> triangles_;
};

}  // namespace

Surface boundary_surface(const HexMesh& mesh) {
    return detail::boundary_surface_where(mesh, [](const auto&) { return true; });
}

Surface detail::boundary_surface_where(const HexMesh& mesh, const std::function<bool(const std::array<Index, 4>&)>& where) {
    Topology topology;  // of its faces only
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

namespace detail {

namespace {

using FaceTest = std::function<bool(const std::array<Index, 4>&)>;

Surface boundary_of_child_where(const HexMesh& mesh, const Topology& topology, const RefineOptions& options,
                                const FaceTest& where) {
    const SchemeRows rows(topology, options);
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

Surface boundary_of_child(const HexMesh& mesh, const Topology& topology, const RefineOptions& options) {
    return boundary_of_child_where(mesh, topology, options, [](const auto&) { return true; });
}

// The cut's faces, too, have a cell on one side only; none of them has a point on the hull.
Surface boundary_of_child(const HexMesh& mesh, std::span<const std::uint8_t> on_hull, const RefineOptions& options) {
    const auto at_hull = [&](const auto& entity) { return std::ranges::any_of(entity, [&](Index p) { return on_hull[p]; }); };
    HexMesh near;
    near.points = mesh.points;
    near.attributes = {{"hull", 1, {on_hull.begin(), on_hull.end()}}};
    near.creases = mesh.creases;
    std::ranges::copy_if(mesh.cells, std::back_inserter(near.cells), at_hull);
    std::ranges::copy_if(mesh.sharp_faces, std::back_inserter(near.sharp_faces), at_hull);
    near = without_unused_points(std::move(near));
    const auto& hull = near.attributes.front().values;
    return boundary_of_child_where(near, build_topology(near), options, [&](const auto& face) { return hull[face[0]] > 0; });
}

}  // namespace detail

}  // namespace subvol
