// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/boundary_rings.h"

#include <algorithm>

#include "subvol/detail/bucket_sort.h"

namespace subvol::detail {

namespace {

/// The edge of `face` at `point` that is not `edge`.
Index next_spoke(const Topology& topology, Index face, Index point, Index edge) {
    const std::size_t k = slot_of(topology.faces[face], point);
    const Index before = topology.face_edges[face][(k + 3) % 4], after = topology.face_edges[face][k];
    return before == edge ? after : before;
}

std::size_t boundary_edges_at(const Topology& topology, Index point) {
    const auto edges = topology.point_edges[point];
    return static_cast<std::size_t>(
        std::count_if(edges.begin(), edges.end(), [&](Index e) { return topology.edge_on_boundary[e]; }));
}

/// Whether all boundary faces at a point lie in fans between its crease edges, as those about a curve do where bodies touch.
bool are_fans_between_creases(const Topology& topology, Index point) {
    std::size_t sides = 0, in_fans = 0;  // of faces: each has two edges at the point, and each fan is walked from both ends
    for (const Index start : topology.point_edges[point]) {
        if (!topology.edge_on_boundary[start]) continue;
        sides += topology.boundary_faces_at(start);
        if (!topology.edge_is_crease[start]) continue;
        for (Index face : topology.edge_faces[start]) {
            if (!topology.face_on_boundary(face)) continue;
            Index edge = start;
            while (true) {
                ++in_fans;
                edge = next_spoke(topology, face, point, edge);
                if (topology.edge_is_crease[edge]) break;
                face = other_boundary_face(topology, edge, face);
            }
        }
    }
    return in_fans == sides;
}

PointKind classify(const Topology& topology, Index point) {
    if (!topology.point_on_boundary[point]) return PointKind::Interior;
    int creases = 0;
    Index start = kNone;
    bool manifold = true, rim = false;
    for (const Index e : topology.point_edges[point]) {
        if (!topology.edge_on_boundary[e]) continue;
        creases += topology.edge_is_crease[e];
        const auto faces = topology.edge_faces[e];
        manifold &= std::count_if(faces.begin(), faces.end(), [&](Index f) { return topology.face_on_hull(f); }) <= 2;
        rim |= topology.boundary_faces_at(e) != 2;
        if (start == kNone) start = e;
    }
    if (creases != 0 && creases != 2) return PointKind::Corner;
    if (!manifold) return are_fans_between_creases(topology, point) ? PointKind::Crease : PointKind::Corner;
    if (rim) return creases == 2 ? PointKind::Crease : PointKind::Corner;  // where sharp faces end or meet the hull
    thread_local std::vector<Index> ring;
    ring_of_spokes(topology, point, start, ring);
    if (ring.size() != boundary_edges_at(topology, point)) return PointKind::Corner;  // several fans of faces
    return creases == 0 ? PointKind::Smooth : PointKind::Crease;
}

}  // namespace

std::pair<Index, Index> boundary_faces_of(const Topology& topology, Index edge) {
    Index first = kNone, last = kNone;
    for (const Index f : topology.edge_faces[edge]) {
        if (!topology.face_on_boundary(f)) continue;
        if (first == kNone) first = f;
        last = f;
    }
    return {first, last};
}

Index other_boundary_face(const Topology& topology, Index edge, Index face) {
    const auto [first, last] = boundary_faces_of(topology, edge);
    return first == face ? last : first;
}

void ring_of_spokes(const Topology& topology, Index point, Index start, std::vector<Index>& ring) {
    ring.clear();
    Index edge = start;
    // The direction is fixed: across the smaller of the two faces at `start`.
    const auto [f0, f1] = boundary_faces_of(topology, start);
    Index face = std::min(f0, f1);
    do {
        ring.push_back(edge);
        edge = next_spoke(topology, face, point, edge);
        face = other_boundary_face(topology, edge, face);
    } while (edge != start && ring.size() <= topology.point_edges[point].size());
}

bool is_touching_point(const Topology& topology, Index point) {
    Index start = kNone;
    for (const Index e : topology.point_edges[point]) {
        if (!topology.edge_on_boundary[e]) continue;
        if (topology.boundary_faces_at(e) != 2) return false;
        if (start == kNone) start = e;
    }
    if (start == kNone) return false;
    thread_local std::vector<Index> ring;
    ring_of_spokes(topology, point, start, ring);
    return ring.size() != boundary_edges_at(topology, point);
}

std::vector<PointKind> classify_points(const Topology& topology) {
    std::vector<PointKind> kinds(topology.point_count);
    parallel_each(kinds.size(), [&](std::size_t p) { kinds[p] = classify(topology, static_cast<Index>(p)); });
    return kinds;
}

std::vector<std::uint8_t> regular_points(const Topology& topology) {
    std::vector<std::uint8_t> regular(topology.point_count);
    parallel_each(regular.size(), [&](std::size_t p) {
        const auto edges = topology.point_edges[p];
        regular[p] = edges.size() == 6 && std::all_of(edges.begin(), edges.end(), [&](Index e) {
                         return topology.edge_has_ring[e] && topology.edge_cells[e].size() == 4;
                     });
    });
    return regular;
}

}  // namespace subvol::detail
