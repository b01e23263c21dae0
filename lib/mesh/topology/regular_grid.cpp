// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/regular_grid.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "subvol/cell.h"
#include "subvol/detail/turned_cell.h"

namespace subvol::detail {

namespace {

/// A grid of side³ points about a cell, and the steps that lead from the cell to its ends.
template <std::size_t kSide>
struct Grid {
    static constexpr int kReach = static_cast<int>(kSide) / 2 - 1;
    static constexpr std::size_t kSteps = kSide - 1;  // cells along an axis
    std::array<Index, kSide * kSide * kSide>& points;

    [[nodiscard]] static std::size_t node(std::size_t i, std::size_t j, std::size_t k) { return i + kSide * (j + kSide * k); }

    /// Puts the corners of the cell at an offset from the centre into the grid; false if another point is there already.
    [[nodiscard]] bool put(const TurnedCell& cell, const std::array<int, 3>& offset) const {
        for (std::size_t k = 0; k < 8; ++k) {
            const auto along = [&](std::size_t axis) {
                return static_cast<std::size_t>(kReach + offset[axis] + static_cast<int>(k >> axis & 1));
            };
            Index& there = points[node(along(0), along(1), along(2))];
            if (there != kNone && there != cell.corners[k]) return false;
            there = cell.corners[k];
        }
        return true;
    }

    /// Fills the grid with the cells that can be reached by steps; false if they do not fit together.
    [[nodiscard]] bool fill(const Topology& topology, Index cell) const {
        points.fill(kNone);
        std::array<std::optional<TurnedCell>, kSteps * kSteps * kSteps> cells;
        const auto at = [&](const std::array<int, 3>& offset) -> std::optional<TurnedCell>& {
            const auto along = [&](std::size_t a) { return static_cast<std::size_t>(offset[a] + kReach); };
            return cells[along(0) + kSteps * (along(1) + kSteps * along(2))];
        };
        std::array<int, 3> offset{};
        at(offset) = as_it_is(topology, cell);
        if (!put(*at(offset), offset)) return false;
        // By distance along u, then v, then w: each cell is one step from a cell that was reached before.
        const auto reach = [&](std::size_t axis) {
            const int side = offset[axis] > 0 ? 1 : 0;
            std::array<int, 3> before = offset;
            before[axis] -= 2 * side - 1;
            const auto& from = at(before);
            if (from) at(offset) = cell_beyond(topology, *from, axis, static_cast<std::size_t>(side));
            return !at(offset) || put(*at(offset), offset);
        };
        constexpr std::array<int, 5> kOrder{0, -1, 1, -2, 2};
        constexpr std::size_t kCount = kReach == 1 ? 3 : 5;
        for (std::size_t w = 0; w < kCount; ++w) {
            for (std::size_t v = 0; v < kCount; ++v) {
                for (std::size_t u = 0; u < kCount; ++u) {
                    offset = {kOrder[u], kOrder[v], kOrder[w]};
                    const bool reached = offset[2] != 0   ? reach(2)
                                         : offset[1] != 0 ? reach(1)
                                         : offset[0] != 0 ? reach(0)
                                                          : true;
                    if (!reached) return false;
                }
            }
        }
        return true;
    }

    /// Whether only whole layers are missing.
    [[nodiscard]] bool has_whole_layers() const {
        const auto at = [&](std::size_t i, std::size_t j, std::size_t k) { return points[node(i, j, k)] == kNone; };
        constexpr auto kInside = static_cast<std::size_t>(kReach);
        for (std::size_t k = 0; k < kSide; ++k) {
            for (std::size_t j = 0; j < kSide; ++j) {
                for (std::size_t i = 0; i < kSide; ++i) {
                    const bool missing = at(i, kInside, kInside) || at(kInside, j, kInside) || at(kInside, kInside, k);
                    if (at(i, j, k) != missing) return false;
                }
            }
        }
        return true;
    }
};

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
    const Grid<4> found{grid};
    return found.fill(topology, cell) && found.has_whole_layers();
}

bool wide_grid(const Topology& topology, std::span<const std::uint8_t> is_grid, Index cell, WidePoints& grid) {
    for (const Index p : topology.cells[cell]) {
        if (is_grid[p] == 0) return false;
    }
    const Grid<6> found{grid};
    if (!found.fill(topology, cell) || !found.has_whole_layers()) return false;
    for (std::size_t k = 1; k < 5; ++k) {
        for (std::size_t j = 1; j < 5; ++j) {
            for (std::size_t i = 1; i < 5; ++i) {
                const Index p = grid[Grid<6>::node(i, j, k)];
                if (p != kNone && is_grid[p] == 0) return false;
            }
        }
    }
    return true;
}

void cross_grid(const Topology& topology, Index cell, GridPoints& grid) {
    grid.fill(kNone);
    const Grid<4> found{grid};
    const TurnedCell center = as_it_is(topology, cell);
    std::ignore = found.put(center, {0, 0, 0});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t side = 0; side < 2; ++side) {
            std::array<int, 3> offset{};
            offset[axis] = side == 0 ? -1 : 1;
            if (const auto beyond = cell_beyond(topology, center, axis, side)) std::ignore = found.put(*beyond, offset);
        }
    }
}

}  // namespace subvol::detail
