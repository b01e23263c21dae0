// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <utility>
#include <vector>

#include "subvol/approximate.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/probe.h"
#include "subvol/surface.h"
#include "subvol/topology.h"
#include "surface_tree.h"

namespace subvol {

using namespace detail;

namespace {

/// The boundary of a mesh as triangles of its own points, two for each side of a cell.
struct Hull {
    Surface surface;
    std::vector<Index> cells;  // of each side
};

Hull hull_of(const HexMesh& mesh) {
    const Topology topology = build_topology(mesh);
    Hull hull{{mesh.points, {}}, {}};
    for (Index face = 0; face < topology.faces.size(); ++face) {
        if (!topology.face_on_hull(face)) continue;
        const Index cell = topology.face_cells[face][0];
        const auto& [a, b, c, d] = topology.faces[face];  // which side is outside does not matter
        hull.surface.triangles.push_back({a, b, c});
        hull.surface.triangles.push_back({a, c, d});
        hull.cells.push_back(cell);
    }
    return hull;
}

}  // namespace

Facts facts_of(const MapReport& report) {
    Facts facts;
    facts["outside"] = report.outside;
    facts["farthest_world"] = report.farthest_world;
    facts["farthest_at"] = std::array{report.farthest_at.x, report.farthest_at.y, report.farthest_at.z};
    return facts;
}

MappedFields map_fields(HexMesh onto, const HexMesh& data, Progress* progress) {
    if (data.cells.empty()) throw Error(ErrorCode::InvalidInput, "has no cells", "data", "a mesh with fields");
    if (data.attributes.empty()) throw Error(ErrorCode::InvalidInput, "has no field", "data", "a mesh with fields");
    const SchemeOptions cells{.kind = Scheme::Linear};
    ProbeResult probed =
        probe_limit(MeshSource(data), onto.points, {.limit = {.scheme = cells, .progress = progress}}, progress);
    MappedFields mapped{std::move(onto), {}};
    mapped.mesh.attributes.clear();
    for (ProbedField& field : probed.fields)
        mapped.mesh.attributes.push_back({field.name, static_cast<int>(field.channels), std::move(field.values)});
    std::vector<Index> outside;
    for (std::size_t p = 0; p < probed.cells.size(); ++p) {
        if (!probed.inside(p)) outside.push_back(static_cast<Index>(p));
    }
    mapped.report.outside = outside.size();
    if (outside.empty()) return mapped;
    if (outside.size() == probed.cells.size())
        throw Error(ErrorCode::InvalidInput, "no point of the mesh lies in the data", "data", "meshes that overlap");
    const Hull hull = hull_of(data);
    const SurfaceTree tree(hull.surface);
    std::vector<SurfacePlace> nearest(outside.size());
    parallel_each(outside.size(), [&](std::size_t k) { nearest[k] = tree.nearest(mapped.mesh.points[outside[k]]); });
    for (std::size_t k = 0; k < outside.size(); ++k) {
        const Index triangle = nearest[k].triangle, cell = hull.cells[triangle / 2];
        const auto& corners = hull.surface.triangles[triangle];
        for (std::size_t f = 0; f < data.attributes.size(); ++f) {
            const Attribute& from = data.attributes[f];
            const auto channels = static_cast<std::size_t>(from.channels);
            for (std::size_t c = 0; c < channels; ++c) {
                double value = from.constant ? from.cells[cell * channels + c] : 0;
                for (std::size_t i = 0; i < 3 && !from.constant; ++i)
                    value += nearest[k].weights[static_cast<int>(i)] * from.values[corners[i] * channels + c];
                mapped.mesh.attributes[f].values[outside[k] * channels + c] = value;
            }
        }
        if (!(nearest[k].distance > mapped.report.farthest_world)) continue;
        mapped.report.farthest_world = nearest[k].distance;
        mapped.report.farthest_at = mapped.mesh.points[outside[k]];
    }
    return mapped;
}

}  // namespace subvol
