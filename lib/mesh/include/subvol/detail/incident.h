// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>

#include "subvol/detail/boundary_rings.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The edges of a cell at each of its corners, along u, v, w.
inline constexpr std::array<std::array<std::size_t, 3>, 8> kCornerEdges = [] {
    std::array<std::array<std::size_t, 3>, 8> edges{};
    for (std::size_t k = 0; k < 12; ++k) {
        for (const std::size_t corner : kCellEdges[k]) edges[corner][k / 4] = k;
    }
    return edges;
}();

/// Calls visit(face, k) once for every face at a point; the point is the face's point k.
template <class Visit>
void each_face_at(const Topology& topology, Index point, const Visit& visit) {
    for (const Index edge : topology.point_edges[point]) {
        for (const Index face : topology.edge_faces[edge]) {
            // Two edges of the face meet at the point: the smaller one reports it.
            const std::size_t k = slot_of(topology.faces[face], point);
            const auto& edges = topology.face_edges[face];
            if (edge == std::min(edges[k], edges[(k + 3) % 4])) visit(face, k);
        }
    }
}

/// Calls visit(cell, k) once for every cell at a point; the point is the cell's corner k.
template <class Visit>
void each_cell_at(const Topology& topology, Index point, const Visit& visit) {
    for (const Index edge : topology.point_edges[point]) {
        for (const Index cell : topology.edge_cells[edge]) {
            // Three edges of the cell meet at the point: the smallest one reports it.
            const std::size_t corner = slot_of(topology.cells[cell], point);
            const auto& edges = topology.cell_edges[cell];
            const auto& [u, v, w] = kCornerEdges[corner];
            if (edge == std::min({edges[u], edges[v], edges[w]})) visit(cell, corner);
        }
    }
}

/// The far ends of the two crease edges at a crease point.
inline std::pair<Index, Index> crease_neighbours(const Topology& topology, Index point) {
    std::pair<Index, Index> ends{kNone, kNone};
    for (const Index e : topology.point_edges[point]) {
        if (!topology.edge_is_crease[e]) continue;
        (ends.first == kNone ? ends.first : ends.second) = other_end(topology, e, point);
    }
    return ends;
}

/// The point of a face diagonally across from one of its points.
inline Index across_face(const Topology& topology, Index face, Index point) {
    const auto& quad = topology.faces[face];
    return quad[(slot_of(quad, point) + 2) % 4];
}

/// The point of a cell across its centre from one of its points. So the points of a side give those of the opposite side, and
/// the points of an edge those of the edge diagonally opposite.
inline Index across_cell(const Topology& topology, Index cell, Index point) {
    constexpr std::array<std::size_t, 8> kAntipode{6, 7, 4, 5, 2, 3, 0, 1};
    return topology.cells[cell][kAntipode[slot_of(topology.cells[cell], point)]];
}

}  // namespace subvol::detail
