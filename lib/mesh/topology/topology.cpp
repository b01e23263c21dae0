// SPDX-License-Identifier: Apache-2.0
// Edges, faces and incidences of a hexahedral mesh, as flat arrays, in this order:
//
//     cells ──► faces ──► a number for each cell, from its sorted faces
//       faces ──► edges: records (two points, face, slot), sorted; equal pairs are one edge, with its faces
//       edges ──► offsets by the smaller point ──► edges of cells, by look-up ──► edges of points
//       hull and tagged faces ──► boundary edges and points ──► rings of faces and cells around edges ──► creases
//
// Sorting makes the numbers of edges and faces depend on point ids alone, not on the order of the cells or on the threads. A
// boundary edge is a crease if it is not manifold, if a single cell lies between two of its boundary faces, or if the mesh tags
// it.
//
// Creases by angle: the two boundary quads at a smooth edge are oriented alike, and the edge is tagged if the cosine between
// their normals is less than that of the angle.
#include "subvol/topology.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "subvol/detail/boundary_rings.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/topology_parts.h"
#include "subvol/error.h"

namespace subvol {

using detail::bucket_sort;
using detail::group_starts;
using detail::parallel_each;

namespace {

struct EdgeRecord {
    std::array<Index, 2> points;
    Index face;
    std::uint8_t slot;
    auto operator<=>(const EdgeRecord&) const = default;
};

void build_edges(Topology& topology) {
    const auto sorted = bucket_sort<EdgeRecord>(
        topology.faces.size(), topology.point_count,
        [&](std::size_t f, const auto& sink) {
            for (std::size_t k = 0; k < 4; ++k) {
                const Index a = topology.faces[f][k], b = topology.faces[f][(k + 1) % 4];
                sink({{std::min(a, b), std::max(a, b)}, static_cast<Index>(f), static_cast<std::uint8_t>(k)});
            }
        },
        [](const EdgeRecord& record) { return record.points[0]; });
    const auto& records = sorted.records;
    auto starts = group_starts(records, [](const auto& a, const auto& b) { return a.points == b.points; });

    const std::size_t count = starts.size() - 1;
    detail::check_count(count, "edges");
    topology.edges.resize(count);
    topology.face_edges.resize(topology.faces.size());
    topology.edge_faces.values.resize(records.size());
    parallel_each(count, [&](std::size_t e) {
        topology.edges[e] = records[starts[e]].points;
        for (std::size_t i = starts[e]; i < starts[e + 1]; ++i) {
            topology.face_edges[records[i].face][records[i].slot] = static_cast<Index>(e);
            topology.edge_faces.values[i] = records[i].face;
        }
    });
    topology.edge_faces.offsets = std::move(starts);
}

void build_edge_offsets(Topology& topology) {
    // Edges are sorted by their smaller points: each edge sets the offsets from the point of the edge before it to its own.
    const auto& edges = topology.edges;
    topology.edge_offsets.resize(topology.point_count + 1);
    parallel_each(edges.size() + 1, [&](std::size_t e) {
        const std::size_t begin = e == 0 ? 0 : edges[e - 1][0] + std::size_t{1};
        const std::size_t end = e == edges.size() ? topology.point_count : edges[e][0];
        for (std::size_t p = begin; p <= end; ++p) topology.edge_offsets[p] = static_cast<Index>(e);
    });
}

void build_cell_edges(Topology& topology) {
    topology.cell_edges.resize(topology.cells.size());
    parallel_each(topology.cells.size(), [&](std::size_t c) {
        for (std::size_t k = 0; k < 12; ++k) {
            const Index a = topology.cells[c][kCellEdges[k][0]];
            const Index b = topology.cells[c][kCellEdges[k][1]];
            topology.cell_edges[c][k] = *topology.find_edge(a, b);
        }
    });
}

void build_point_edges(Topology& topology) {
    struct End {
        Index point, edge;
        auto operator<=>(const End&) const = default;
    };
    auto sorted = bucket_sort<End>(
        topology.edges.size(), topology.point_count,
        [&](std::size_t e, const auto& sink) {
            for (const Index p : topology.edges[e]) sink(End{p, static_cast<Index>(e)});
        },
        [](const End& end) { return end.point; });
    topology.point_edges.offsets = std::move(sorted.offsets);
    topology.point_edges.values.resize(sorted.records.size());
    parallel_each(sorted.records.size(), [&](std::size_t i) { topology.point_edges.values[i] = sorted.records[i].edge; });
}

void mark_boundary(Topology& topology) {
    topology.edge_on_boundary.resize(topology.edges.size());
    topology.point_on_boundary.resize(topology.point_count);
    parallel_each(topology.edges.size(), [&](std::size_t e) {
        const auto faces = topology.edge_faces[e];
        topology.edge_on_boundary[e] = std::ranges::any_of(faces, [&](Index f) { return topology.face_on_boundary(f); });
    });
    parallel_each(topology.point_count, [&](std::size_t p) {
        const auto edges = topology.point_edges[p];
        topology.point_on_boundary[p] = std::ranges::any_of(edges, [&](Index e) { return topology.edge_on_boundary[e] != 0; });
    });
}

/// Marks the tagged faces. On the hull a tag changes nothing, since the hull is boundary in any case.
void mark_sharp_faces(Topology& topology, std::span<const std::array<Index, 4>> tagged) {
    if (tagged.empty()) return;
    topology.face_is_sharp.assign(topology.faces.size(), 0);
    for (const auto& points : tagged) {
        const auto f = topology.find_face(points);
        if (!f) {
            std::string text;
            for (const Index p : points) text += (text.empty() ? "" : " ") + std::to_string(p);
            throw Error(ErrorCode::InvalidInput, "points " + text + " are not a face", "sharp face",
                        "four points of a face of a cell, in cyclic order");
        }
        topology.face_is_sharp[*f] = 1;
    }
}

/// Whether a single cell lies between two boundary faces at the edge. At an edge inside the hull the faces are a ring.
bool has_single_cell(const Topology& topology, Index edge) {
    const auto faces = topology.edge_faces[edge];
    const bool ring = faces.size() == topology.edge_cells[edge].size();
    for (std::size_t i = 0; i + (ring ? 0 : 1) < faces.size(); ++i) {
        if (topology.face_on_boundary(faces[i]) && topology.face_on_boundary(faces[(i + 1) % faces.size()])) return true;
    }
    return false;
}

/// Marks creases by the default rule and by the tags of the mesh.
void mark_creases(Topology& topology, detail::InteriorCreases interior) {
    topology.edge_is_crease.assign(topology.edges.size(), 0);
    std::atomic<std::size_t> nonmanifold{0};
    parallel_each(topology.edges.size(), [&](std::size_t e) {
        if (!topology.edge_on_boundary[e]) return;
        const auto edge = static_cast<Index>(e);
        const bool manifold = topology.boundary_faces_at(edge) == 2;
        if (!manifold) nonmanifold.fetch_add(1, std::memory_order_relaxed);
        topology.edge_is_crease[e] = !manifold || has_single_cell(topology, edge);
    });
    topology.nonmanifold_edges += nonmanifold;
    for (const auto& [a, b] : topology.creases) {
        const auto e = topology.find_edge(a, b);
        if (!e || !topology.edge_on_boundary[*e]) {
            if (interior == detail::InteriorCreases::Ignore) continue;
            throw Error(ErrorCode::InvalidInput,
                        "points " + std::to_string(a) + " and " + std::to_string(b) + " are not a boundary edge", "crease",
                        "creases are edges of the boundary");
        }
        topology.edge_is_crease[*e] = 1;
    }
}

/// Numbers the cells in the order of their sorted face numbers. No two cells have the same faces, and face numbers do not
/// depend on the order of the cells; hence neither do these numbers.
void number_cells(Topology& topology) {
    struct Key {
        std::array<Index, 6> faces;
        Index cell;
        auto operator<=>(const Key&) const = default;
    };
    const auto sorted = bucket_sort<Key>(
        topology.cells.size(), topology.faces.size(),
        [&](std::size_t c, const auto& sink) {
            auto faces = topology.cell_faces[c];
            std::sort(faces.begin(), faces.end());
            sink(Key{faces, static_cast<Index>(c)});
        },
        [](const Key& key) { return key.faces[0]; });
    topology.cell_ordinal.resize(topology.cells.size());
    parallel_each(sorted.records.size(),
                  [&](std::size_t n) { topology.cell_ordinal[sorted.records[n].cell] = static_cast<Index>(n); });
}

}  // namespace

std::size_t Topology::boundary_faces_at(Index edge) const {
    const auto ring = edge_faces[edge];
    return static_cast<std::size_t>(std::count_if(ring.begin(), ring.end(), [&](Index f) { return face_on_boundary(f); }));
}

std::optional<Index> Topology::find_face(const std::array<Index, 4>& points) const {
    const auto e = find_edge(points[0], points[1]);
    if (!e) return std::nullopt;
    for (const Index f : edge_faces[*e]) {
        if (std::is_permutation(points.begin(), points.end(), faces[f].begin())) return f;
    }
    return std::nullopt;
}

std::optional<Index> Topology::find_edge(Index a, Index b) const {
    const std::array<Index, 2> key{std::min(a, b), std::max(a, b)};
    if (key[1] >= point_count) return std::nullopt;
    const auto begin = edges.begin() + edge_offsets[key[0]], end = edges.begin() + edge_offsets[key[0] + 1];
    const auto found = std::lower_bound(begin, end, key);
    if (found == end || *found != key) return std::nullopt;
    return static_cast<Index>(found - edges.begin());
}

Topology detail::build_topology(const HexMesh& mesh, InteriorCreases interior) {
    Topology topology;
    topology.point_count = mesh.points.size();
    topology.cells = mesh.cells;
    detail::build_faces(topology);
    number_cells(topology);
    build_edges(topology);
    build_edge_offsets(topology);
    build_cell_edges(topology);
    build_point_edges(topology);
    mark_sharp_faces(topology, mesh.sharp_faces);
    mark_boundary(topology);
    detail::order_edge_rings(topology);
    topology.creases = mesh.creases;
    mark_creases(topology, interior);
    return topology;
}

Topology build_topology(const HexMesh& mesh) {
    return detail::build_topology(mesh, detail::InteriorCreases::Refuse);
}

namespace {

Vec3 quad_normal(const HexMesh& mesh, const std::array<Index, 4>& q) {
    return glm::cross(mesh.points[q[2]] - mesh.points[q[0]], mesh.points[q[3]] - mesh.points[q[1]]);
}

}  // namespace

void tag_creases(HexMesh& mesh, double angle_deg) {
    if (!(angle_deg > 0 && angle_deg <= 180)) {
        throw Error(ErrorCode::InvalidInput, "the crease angle is " + detail::number_text(angle_deg), {},
                    "more than 0, at most 180 degrees");
    }
    if (angle_deg == 180) return;
    const Topology topology = build_topology(mesh);
    const double limit = std::cos(angle_deg * std::numbers::pi / 180);
    for (Index e = 0; e < topology.edges.size(); ++e) {
        const auto edge = e;
        if (!topology.edge_on_boundary[e] || topology.edge_is_crease[e]) continue;
        const auto [f0, f1] = detail::boundary_faces_of(topology, edge);
        const auto [a, b] = topology.edges[e];
        // One quad is oriented so that its edge goes from a to b, the other from b to a: on a plane their normals are then
        // equal.
        const auto normal = [&](Index face, Index from, Index to) {
            const auto& q = topology.faces[face];
            const std::size_t k = detail::slot_of(q, from);
            const Vec3 n = quad_normal(mesh, q);
            return q[(k + 1) % 4] == to ? n : -n;
        };
        const Vec3 n0 = normal(f0, a, b), n1 = normal(f1, b, a);
        if (glm::dot(n0, n1) < limit * glm::length(n0) * glm::length(n1)) mesh.creases.push_back({a, b});
    }
}

}  // namespace subvol
