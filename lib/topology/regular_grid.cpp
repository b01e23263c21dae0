// SPDX-License-Identifier: Apache-2.0
#include "regular_grid.h"

#include <algorithm>
#include <optional>

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

/// A cell with its corners in the order of the parameters of another cell: corner u + 2v + 4w.
struct TurnedCell {
    Index cell = 0;
    std::array<Index, 8> corners;
};

TurnedCell as_it_is(const Topology& topology, Index cell) {
    TurnedCell turned{cell, {}};
    for (std::size_t k = 0; k < 8; ++k) {
        const auto& [u, v, w] = kCornerParameters[k];
        turned.corners[static_cast<std::size_t>(u + 2 * v + 4 * w)] = topology.cells[cell][k];
    }
    return turned;
}

/// The cell beyond a side (0 low, 1 high) along an axis, turned in the same way.
std::optional<TurnedCell> step(const Topology& topology, const TurnedCell& from, std::size_t axis, std::size_t side) {
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

/// Puts the corners of the cell at an offset from the centre into the grid; false if another point is there already.
bool put(const TurnedCell& cell, const std::array<int, 3>& offset, GridPoints& grid) {
    for (std::size_t k = 0; k < 8; ++k) {
        const auto along = [&](std::size_t axis) {
            return static_cast<std::size_t>(1 + offset[axis] + static_cast<int>(k >> axis & 1));
        };
        const std::size_t node = along(0) + 4 * along(1) + 16 * along(2);
        if (grid[node] != kNone && grid[node] != cell.corners[k]) return false;
        grid[node] = cell.corners[k];
    }
    return true;
}

/// Fills the grid with the 27 cells that can be reached by steps; false if they do not fit together.
bool fill(const Topology& topology, Index cell, GridPoints& grid) {
    grid.fill(kNone);
    const TurnedCell center = as_it_is(topology, cell);
    for (int w = -1; w <= 1; ++w) {
        for (int v = -1; v <= 1; ++v) {
            for (int u = -1; u <= 1; ++u) {
                std::optional<TurnedCell> at = center;
                const std::array<int, 3> offset{u, v, w};
                for (std::size_t a = 0; a < 3; ++a) {
                    if (offset[a] != 0 && at) at = step(topology, *at, a, offset[a] > 0 ? 1 : 0);
                }
                if (at && !put(*at, offset, grid)) return false;
            }
        }
    }
    return true;
}

/// Whether only whole layers are missing.
bool has_whole_layers(const GridPoints& grid) {
    const auto at = [&](std::size_t i, std::size_t j, std::size_t k) { return grid[i + 4 * j + 16 * k] == kNone; };
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t j = 0; j < 4; ++j) {
            for (std::size_t i = 0; i < 4; ++i) {
                if (at(i, j, k) != (at(i, 1, 1) || at(1, j, 1) || at(1, 1, k))) return false;
            }
        }
    }
    return true;
}

}  // namespace

bool is_grid_point(const Topology& topology, Index point) {
    std::size_t inner = 0, smooth = 0, sharp = 0;
    const auto edges = topology.point_edges[point];
    for (const Index e : edges) {
        const std::size_t cells = topology.edge_cells[e].size();
        if (!topology.edge_on_boundary[e]) {
            inner += topology.edge_has_ring[e] && cells == 4;
        } else if (topology.edge_is_crease[e]) {
            sharp += cells == 1;
        } else {
            smooth += cells == 2 && topology.edge_faces[e].size() == 3;
        }
    }
    switch (edges.size()) {
        case 6:
            return inner == 6;
        case 5:
            return inner == 1 && smooth == 4;
        case 4:
            return smooth == 2 && sharp == 2;
        case 3:
            return sharp == 3;
        default:
            return false;
    }
}

bool regular_grid(const Topology& topology, Index cell, GridPoints& grid) {
    for (const Index p : topology.cells[cell]) {
        if (!is_grid_point(topology, p)) return false;
    }
    return fill(topology, cell, grid) && has_whole_layers(grid);
}

void cross_grid(const Topology& topology, Index cell, GridPoints& grid) {
    grid.fill(kNone);
    const TurnedCell center = as_it_is(topology, cell);
    put(center, {0, 0, 0}, grid);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t side = 0; side < 2; ++side) {
            std::array<int, 3> offset{};
            offset[axis] = side == 0 ? -1 : 1;
            if (const auto beyond = step(topology, center, axis, side)) put(*beyond, offset, grid);
        }
    }
}

}  // namespace subvol::detail
