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
    const std::size_t bit = std::size_t{1} << axis;
    std::array<Index, 4> shared;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        if (((k & bit) != 0) == (side == 1)) shared[count++] = from.corners[k];
    }
    const auto in = [](const auto& list, Index p) { return std::find(list.begin(), list.end(), p) != list.end(); };
    for (const Index f : topology.cell_faces[from.cell]) {
        const auto& quad = topology.faces[f];
        if (!in(quad, shared[0]) || !in(quad, shared[3])) continue;
        const auto [c0, c1] = topology.face_cells[f];
        if (c1 == kNone) return std::nullopt;
        TurnedCell next{c0 == from.cell ? c1 : c0, {}};
        const auto& cell = topology.cells[next.cell];
        for (std::size_t k = 0; k < 8; ++k) {
            if (((k & bit) != 0) != (side == 1)) continue;
            const Index p = from.corners[k];
            const auto slot = static_cast<std::size_t>(std::find(cell.begin(), cell.end(), p) - cell.begin());
            next.corners[k ^ bit] = p;
            for (const std::size_t n : kCornerNeighbors[slot]) {
                if (!in(shared, cell[n])) next.corners[k] = cell[n];
            }
        }
        return next;
    }
    return std::nullopt;
}

}  // namespace subvol::detail
