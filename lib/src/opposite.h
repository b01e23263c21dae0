#pragma once

#include "boundary_rings.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The point of a face diagonally across from one of its points.
inline Index across_face(const Topology& topology, Index face, Index point) {
    const auto& quad = topology.faces[face];
    return quad[(slot_of(quad, point) + 2) % 4];
}

/// The point of a cell across its centre from one of its points. Those of a side are the points of the opposite side, those of
/// an edge the points of the edge diagonally opposite.
inline Index across_cell(const Topology& topology, Index cell, Index point) {
    constexpr std::array<std::size_t, 8> kAntipode{6, 7, 4, 5, 2, 3, 0, 1};
    return topology.cells[cell][kAntipode[slot_of(topology.cells[cell], point)]];
}

}  // namespace subvol::detail
