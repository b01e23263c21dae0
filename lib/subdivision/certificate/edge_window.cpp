// SPDX-License-Identifier: Apache-2.0
// The window of a segment of an irregular edge in a mesh, and the rules that take it to the windows of its halves: found by
// refining stars, so no rule of a scheme is written again. A window is refused where anything but the edge is irregular within
// the reach of the rules: a second irregular edge, a crease, a sharp face, or a boundary that is not a straight end of the
// edge.
#include "edge_window.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "subvol/detail/boundary_rings.h"
#include "subvol/detail/regular_grid.h"
#include "subvol/refine.h"

namespace subvol::detail {

namespace {

bool has_valence(const Topology& topology, Index edge, std::size_t cells) {
    return topology.edge_has_ring[edge] != 0 && topology.edge_cells[edge].size() == cells;
}

// The cell with the axes u and v across an edge of it, and w along the edge from its first corner; right-handed as the cell is.
TurnedCell along_edge(const Topology& topology, Index cell, std::size_t edge) {
    const auto& [from, to] = kCellEdges[edge];
    std::array<std::size_t, 3> axes = kCornerNeighbors[from];
    while (axes[2] != to) std::rotate(axes.begin(), axes.begin() + 1, axes.end());
    return turned_at(topology, cell, from, axes);
}

// The cell with u along the former v, and v against the former u.
TurnedCell quarter_turn(const TurnedCell& from) {
    TurnedCell turned{from.cell, {}};
    for (std::size_t k = 0; k < 8; ++k) {
        const std::size_t u = k & 1, v = k >> 1 & 1, w = k >> 2;
        turned.corners[k] = from.corners[(1 - v) + 2 * u + 4 * w];
    }
    return turned;
}

// A mesh of a star and `layers` layers of cells along its edge; rules do not use positions.
HexMesh star_mesh(const Star& star, std::size_t layers) {
    HexMesh mesh;
    mesh.points.resize(star.points() * (layers + 1));
    const auto reach = static_cast<int>(star.reach);
    for (std::size_t l = 0; l < layers; ++l) {
        for (std::size_t s = 0; s < star.cells; ++s) {
            for (int i = 0; i < reach; ++i) {
                for (int j = 0; j < reach; ++j) {
                    std::array<Index, 8> cell{};
                    for (std::size_t k = 0; k < 8; ++k) {
                        const auto& [u, v, w] = kCornerParameters[k];
                        const std::size_t layer = l + static_cast<std::size_t>(w);
                        cell[k] = static_cast<Index>(layer * star.points() + star.number(s, i + u, j + v));
                    }
                    mesh.cells.push_back(cell);
                }
            }
        }
    }
    return mesh;
}

}  // namespace

TurnedCell turned_at(const Topology& topology, Index cell, std::size_t corner, const std::array<std::size_t, 3>& axes) {
    TurnedCell turned{cell, {}};
    for (std::size_t k = 0; k < 8; ++k) {
        std::array<int, 3> at = kCornerParameters[corner];
        for (std::size_t a = 0; a < 3; ++a) {
            if ((k >> a & 1) == 0) continue;
            for (std::size_t c = 0; c < 3; ++c) at[c] += kCornerParameters[axes[a]][c] - kCornerParameters[corner][c];
        }
        turned.corners[k] = topology.cells[cell][kCornerOctants[static_cast<std::size_t>(at[0] + 2 * at[1] + 4 * at[2])]];
    }
    return turned;
}

bool is_on_straight_edge(const Topology& topology, Index point, std::size_t cells, bool is_end) {
    std::size_t along = 0, across = 0, smooth = 0;
    const auto edges = topology.point_edges[point];
    for (const Index e : edges) {
        along += has_valence(topology, e, cells) ? 1 : 0;
        across += has_valence(topology, e, 4) ? 1 : 0;
        smooth += topology.edge_on_boundary[e] != 0 && topology.edge_is_crease[e] == 0 && topology.edge_cells[e].size() == 2 &&
                          topology.edge_faces[e].size() == 3
                      ? 1
                      : 0;
    }
    if (is_end) return along == 1 && smooth == cells && edges.size() == cells + 1;
    return along == 2 && across == cells && edges.size() == cells + 2 && topology.point_on_boundary[point] == 0;
}

bool is_regular_point(const Topology& topology, Index point, bool on_side) {
    return topology.point_edges[point].size() == (on_side ? 5 : 6) && is_grid_point(topology, point);
}

std::size_t Star::number(std::size_t s, int i, int j) const {
    if (j < 0) return number((s + cells - 1) % cells, -j, i);
    if (i < 0) return number((s + 1) % cells, j, -i);
    if (i == 0 && j == 0) return 0;
    if (i == 0) return number((s + 1) % cells, j, 0);
    return 1 + (s * reach + static_cast<std::size_t>(i) - 1) * (reach + 1) + static_cast<std::size_t>(j);
}

std::optional<Index> irregular_edge(const Topology& topology, Index cell) {
    std::optional<Index> irregular;
    for (const Index edge : topology.cell_edges[cell]) {
        if (has_valence(topology, edge, 4) || topology.edge_on_boundary[edge] != 0) continue;
        if (irregular) return std::nullopt;
        irregular = edge;
    }
    return irregular;
}

std::optional<EdgeWindow> edge_window(const Topology& topology, Index cell) {
    const std::optional<Index> edge = irregular_edge(topology, cell);
    if (!edge) return std::nullopt;
    const std::size_t cells = topology.edge_cells[*edge].size(), irregular = slot_of(topology.cell_edges[cell], *edge);
    if (!has_valence(topology, *edge, cells)) return std::nullopt;
    const TurnedCell at_edge = along_edge(topology, cell, irregular);
    std::array<bool, 2> is_end{};  // whether the edge ends at the boundary at its low and high end
    for (std::size_t side = 0; side < 2; ++side) {
        is_end[side] = !cell_beyond(topology, at_edge, 2, side);
        if (!is_on_straight_edge(topology, at_edge.corners[4 * side], cells, is_end[side])) return std::nullopt;
    }
    const Star star{cells, EdgeWindow::kReach};
    EdgeWindow window{cells, std::vector<Index>(EdgeWindow::kLayers * star.points(), kNone)};
    const auto put = [&](const TurnedCell& at, std::size_t s, int i, int j, int layer) {
        for (std::size_t k = 0; k < 8; ++k) {
            const int u = k & 1, v = k >> 1 & 1, w = k >> 2 & 1;
            const auto l = static_cast<std::size_t>(layer + 1 + w);
            Index& there = window.points[l * star.points() + star.number(s, i + u, j + v)];
            if (there != kNone && there != at.corners[k]) return false;
            there = at.corners[k];
        }
        return true;
    };
    TurnedCell first = at_edge;
    for (std::size_t s = 0; s < cells; ++s) {
        std::optional<TurnedCell> column = first;
        for (int n = 0; n < 4; ++n) {  // the cells (0, 0), (1, 0), (1, 1) and (0, 1) of the sector
            const int i = n == 1 || n == 2 ? 1 : 0, j = n == 2 || n == 3 ? 1 : 0;
            if (n > 0) column = cell_beyond(topology, *column, n == 2 ? 1 : 0, n == 3 ? 0 : 1);
            if (!column || !put(*column, s, i, j, 0)) return std::nullopt;
            for (std::size_t side = 0; side < 2; ++side) {
                const auto beyond = cell_beyond(topology, *column, 2, side);
                if (beyond.has_value() == is_end[side]) return std::nullopt;
                if (beyond && !put(*beyond, s, i, j, side == 0 ? -1 : 1)) return std::nullopt;
            }
        }
        const auto next = cell_beyond(topology, first, 0, 0);
        if (!next) return std::nullopt;
        first = quarter_turn(*next);
    }
    for (std::size_t s = 0; s < cells; ++s) {
        for (const std::size_t p : {star.number(s, 1, 0), star.number(s, 1, 1)}) {
            for (std::size_t side = 0; side < 2; ++side) {
                if (!is_regular_point(topology, window.points[(1 + side) * star.points() + p], is_end[side]))
                    return std::nullopt;
            }
        }
    }
    return window;
}

// The rules come from a star that is larger than the window, so that its boundary does not matter.
EdgeRules edge_rules(Scheme scheme, std::size_t cells) {
    constexpr std::size_t kMeshReach = 3, kMeshLayers = 5, kStart = 2;  // start: the layer where the segment starts
    const Star coarse{cells, kMeshReach}, fine{cells, 2 * kMeshReach}, star{cells, EdgeWindow::kReach};
    const HexMesh mesh = star_mesh(coarse, kMeshLayers);
    const RefinementTables tables = refinement_tables(build_topology(mesh), {.scheme = {.kind = scheme}, .levels = 1});
    const HexMesh fine_mesh = star_mesh(fine, 2 * kMeshLayers);
    // Child k of a cell lies at its corner k, so the places of points follow from their cells.
    std::vector<Index> numbers(fine_mesh.points.size(), kNone);
    std::size_t number = 0;
    for (std::size_t l = 0; l < kMeshLayers; ++l) {
        for (std::size_t s = 0; s < cells; ++s) {
            for (std::size_t n = 0; n < kMeshReach * kMeshReach; ++n, ++number) {
                for (std::size_t child = 0; child < 8; ++child) {
                    for (std::size_t k = 0; k < 8; ++k) {
                        const auto along = [&](std::size_t axis, std::size_t first) {
                            return 2 * static_cast<int>(first) + kCornerParameters[child][axis] + kCornerParameters[k][axis];
                        };
                        const std::size_t layer = static_cast<std::size_t>(along(2, l));
                        const std::size_t p = fine.number(s, along(0, n / kMeshReach), along(1, n % kMeshReach));
                        numbers[layer * fine.points() + p] = tables.cells[8 * number + child][k];
                    }
                }
            }
        }
    }
    const std::size_t columns = EdgeWindow::kLayers * star.points();
    std::vector<double> units(mesh.points.size() * columns, 0.0);
    const auto each_point = [&](const auto& visit) {  // visit(number in the window, sector, i, j, layer)
        for (int layer = -1; layer <= 2; ++layer) {
            for (std::size_t s = 0; s < cells; ++s) {
                for (int i = 0; i <= 2; ++i) {
                    for (int j = 0; j <= 2; ++j) {
                        visit(static_cast<std::size_t>(layer + 1) * star.points() + star.number(s, i, j), s, i, j, layer);
                    }
                }
            }
        }
    };
    each_point([&](std::size_t at, std::size_t s, int i, int j, int layer) {
        const auto in_mesh =
            static_cast<std::size_t>(static_cast<int>(kStart) + layer) * coarse.points() + coarse.number(s, i, j);
        units[in_mesh * columns + at] = 1;
    });
    const std::vector<double> weights = tables.apply(std::span<const double>(units), columns);
    // Rules about the edge divide by m, m², m + 2 and powers of 2.
    const auto m = static_cast<double>(cells);
    const double denominator = 512 * m * m * (m + 2);
    const auto put_row = [&](Eigen::MatrixXd& rows, std::size_t row, std::size_t s, int i, int j, int layer) {
        const auto l = static_cast<std::size_t>(2 * static_cast<int>(kStart) + layer);
        const std::size_t point = numbers[l * fine.points() + fine.number(s, i, j)];
        for (std::size_t c = 0; c < columns; ++c) {
            const double numerator = weights[point * columns + c] * denominator, whole = std::round(numerator);
            constexpr double kSame = 1e-6;
            rows(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c)) =
                std::abs(numerator - whole) < kSame ? whole / denominator : std::numeric_limits<double>::quiet_NaN();
        }
    };
    EdgeRules rules{cells, {}, {}};
    for (int half = 0; half < 2; ++half) {
        auto& rows = rules.halves[static_cast<std::size_t>(half)];
        rows.resize(static_cast<Eigen::Index>(columns), static_cast<Eigen::Index>(columns));
        each_point([&](std::size_t at, std::size_t s, int i, int j, int layer) { put_row(rows, at, s, i, j, half + layer); });
    }
    for (int n = 0; n < 2; ++n) {
        auto& rows = rules.ring[static_cast<std::size_t>(n)];
        rows.resize(64, static_cast<Eigen::Index>(columns));
        for (int p = 0; p < 64; ++p) put_row(rows, static_cast<std::size_t>(p), 0, p / 16, n - 1 + p / 4 % 4, p % 4 - 1);
    }
    return rules;
}

std::vector<std::size_t> window_symmetry(std::size_t cells, std::size_t turn, bool mirror, bool exchange) {
    const Star star{cells, EdgeWindow::kReach};
    std::vector<std::size_t> to(EdgeWindow::kLayers * star.points());
    for (std::size_t s = 0; s < cells; ++s) {
        for (int i = 0; i <= 2; ++i) {
            for (int j = 0; j <= 2; ++j) {
                const std::size_t sector = ((mirror ? cells - 1 - s : s) + turn) % cells;
                const std::size_t p = star.number(s, i, j), q = star.number(sector, mirror ? j : i, mirror ? i : j);
                for (std::size_t l = 0; l < EdgeWindow::kLayers; ++l) {
                    to[l * star.points() + p] = (exchange ? EdgeWindow::kLayers - 1 - l : l) * star.points() + q;
                }
            }
        }
    }
    return to;
}

std::vector<RowsXd> whole_ring(const EdgeRules& rules) {
    std::vector<RowsXd> cells;
    const auto add = [&](const Eigen::MatrixXd& ring, std::size_t turn, bool mirror, bool exchange) {
        const std::vector<std::size_t> to = window_symmetry(rules.cells, turn, mirror, exchange);
        RowsXd rows = RowsXd::Zero(64, ring.cols());
        for (Eigen::Index p = 0; p < 64; ++p) {
            const Eigen::Index a = p / 16, b = p / 4 % 4, c = exchange ? 3 - p % 4 : p % 4;
            const Eigen::Index row = mirror ? (4 * b + a) * 4 + c : (4 * a + b) * 4 + c;
            for (std::size_t k = 0; k < to.size(); ++k) {
                rows(row, static_cast<Eigen::Index>(to[k])) = ring(p, static_cast<Eigen::Index>(k));
            }
        }
        cells.push_back(std::move(rows));
    };
    for (std::size_t s = 0; s < rules.cells; ++s) {
        for (const bool exchange : {false, true}) {
            add(rules.ring[0], s, false, exchange);
            add(rules.ring[1], s, false, exchange);
            add(rules.ring[0], s, true, exchange);
        }
    }
    return cells;
}

}  // namespace subvol::detail
