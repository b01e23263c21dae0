// SPDX-License-Identifier: Apache-2.0
// What lies beside and opposite within a face or a cell.
#pragma once

#include <array>

#include "subvol/detail/boundary_rings.h"
#include "subvol/topology.h"

namespace subvol::detail {

using Pair = std::array<Index, 2>;

/// The neighbour of `point` in a face that is not `other`; `other` must be its other neighbour.
inline Index beside(const Topology& topology, Index face, Index point, Index other) {
    const auto& quad = topology.faces[face];
    const std::size_t k = slot_of(quad, point);
    const Index next = quad[(k + 1) % 4];
    return next == other ? quad[(k + 3) % 4] : next;
}

inline Index edge_in_face(const Topology& topology, Index face, Index a, Index b) {
    const auto& quad = topology.faces[face];
    const std::size_t k = slot_of(quad, a);
    return topology.face_edges[face][quad[(k + 1) % 4] == b ? k : (k + 3) % 4];
}

/// The two points of a face that are not on one of its edges, in the order of the edge's ends.
inline Pair far_side(const Topology& topology, Index face, Index edge) {
    const auto [a, b] = topology.edges[edge];
    return {beside(topology, face, a, b), beside(topology, face, b, a)};
}

/// The edge of a cell diagonally opposite another.
inline Pair opposite_edge(const Topology& topology, Index cell, Index edge) {
    const std::size_t k = slot_of(topology.cell_edges[cell], edge);
    // The four edges along an axis are listed 00, 10, 01, 11 over the other two axes: the opposite one is 3 − i.
    return topology.edges[topology.cell_edges[cell][k / 4 * 4 + 3 - k % 4]];
}

inline std::array<Index, 4> side_points(const Topology& topology, Index cell, std::size_t side) {
    std::array<Index, 4> points;
    for (std::size_t k = 0; k < 4; ++k) points[k] = topology.cells[cell][static_cast<std::size_t>(kCellFaces[side][k])];
    return points;
}

/// The four points of a cell that are not on one of its faces.
inline std::array<Index, 4> opposite_points(const Topology& topology, Index cell, Index face) {
    return side_points(topology, cell, slot_of(topology.cell_faces[cell], face) ^ 1);
}

/// The points over two points of a face, in both of its cells.
inline std::array<Index, 4> lifted(const Topology& topology, Index face, const Pair& points) {
    std::array<Index, 4> result{};
    std::size_t count = 0;
    for (const Index cell : topology.face_cells[face]) {
        const std::size_t side = slot_of(topology.cell_faces[cell], face);
        const auto axis = static_cast<std::size_t>(side / 2);
        for (const Index p : points) {
            for (std::size_t k = 4 * axis; k < 4 * axis + 4; ++k) {
                const auto& edge = kCellEdges[k];
                const Index a = topology.cells[cell][static_cast<std::size_t>(edge[0])];
                const Index b = topology.cells[cell][static_cast<std::size_t>(edge[1])];
                if (a == p) result[count++] = b;
                if (b == p) result[count++] = a;
            }
        }
    }
    return result;
}

}  // namespace subvol::detail
