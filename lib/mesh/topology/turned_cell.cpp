// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/turned_cell.h"

#include <algorithm>

#include "subvol/cell.h"

namespace subvol::detail {

TurnedCell as_it_is(const Topology& topology, Index cell) {
    TurnedCell turned{cell, {}};
    for (std::size_t k = 0; k < 8; ++k) {
        const auto& [u, v, w] = kCornerParameters[k];
        turned.corners[static_cast<std::size_t>(u + 2 * v + 4 * w)] = topology.cells[cell][k];
    }
    return turned;
}

std::optional<TurnedCell> cell_beyond(const Topology& topology, const TurnedCell& from, std::size_t axis, std::size_t side) {
    const std::size_t bit = std::size_t{1} << axis, low = side == 1 ? bit : 0;  // the first corner of the side
    const auto octant_in = [](const std::array<Index, 8>& cell, Index point) {
        return kCornerOctants[static_cast<std::size_t>(std::find(cell.begin(), cell.end(), point) - cell.begin())];
    };
    // Two opposite corners of the side have the same parameter of a cell along one axis alone: the bit of the side's axis.
    const auto axis_bit = [&](const std::array<Index, 8>& cell) {
        return 7 ^ octant_in(cell, from.corners[low]) ^ octant_in(cell, from.corners[low ^ bit ^ 7]);
    };
    const auto& here = topology.cells[from.cell];
    const std::size_t across = axis_bit(here);  // 1, 2 or 4
    const std::size_t face = across / 2 * 2 + ((octant_in(here, from.corners[low]) & across) != 0 ? 1 : 0);
    const auto [c0, c1] = topology.face_cells[topology.cell_faces[from.cell][face]];
    if (c1 == kNone) return std::nullopt;
    TurnedCell next{c0 == from.cell ? c1 : c0, {}};
    const auto& there = topology.cells[next.cell];
    const std::size_t on = axis_bit(there);
    for (std::size_t k = 0; k < 8; ++k) {
        if ((k & bit) != low) continue;
        const Index p = from.corners[k];
        next.corners[k ^ bit] = p;
        next.corners[k] = there[kCornerOctants[octant_in(there, p) ^ on]];
    }
    return next;
}

}  // namespace subvol::detail
