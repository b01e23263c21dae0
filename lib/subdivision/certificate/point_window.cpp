// SPDX-License-Identifier: Apache-2.0
// The window of an irregular point in a mesh, and the kind of the point: its cells as triangles of a link, in an order that
// does not depend on the numbers of cells. Where bodies touch in the point, where it has a crease, or where the boundary is not
// smooth around it there is no window, since the rules at the point are others than those of its link.
#include "point_window.h"

#include <algorithm>
#include <deque>

#include "edge_window.h"
#include "subvol/detail/regular_grid.h"
#include "subvol/refine.h"

namespace subvol::detail {

namespace {

using Triangle = std::array<int, 3>;

// A link in the order in which it is met from a triangle, its sides turned until `first` comes first; and the triangles'
// numbers.
struct OrderedLink {
    PointLink link;
    std::vector<std::size_t> triangles;
    std::vector<Triangle> directions;  // of the given link, in the order of `link`
    std::vector<int> code;             // the link, and where it has a rim
};

OrderedLink ordered_from(const PointLink& link, const std::map<std::array<int, 2>, std::size_t>& sides, std::size_t start,
                         std::size_t first) {
    OrderedLink ordered;
    std::map<int, int> labels;
    std::vector<std::uint8_t> met(link.size(), 0);
    std::deque<std::pair<std::size_t, Triangle>> queue;
    Triangle from = link[start];
    std::rotate(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(first), from.end());
    queue.push_back({start, from});
    met[start] = 1;
    while (!queue.empty()) {
        const auto [t, triangle] = queue.front();
        queue.pop_front();
        Triangle labelled{};
        for (std::size_t v = 0; v < 3; ++v) {
            labelled[v] = labels.try_emplace(triangle[v], static_cast<int>(labels.size())).first->second;
            ordered.code.push_back(labelled[v]);
        }
        ordered.link.push_back(labelled);
        ordered.triangles.push_back(t);
        ordered.directions.push_back(triangle);
        for (std::size_t v = 0; v < 3; ++v) {
            const int a = triangle[v], b = triangle[(v + 1) % 3];
            const auto beyond = sides.find({b, a});
            ordered.code.push_back(beyond == sides.end() ? -1 : -2);
            if (beyond == sides.end() || met[beyond->second] != 0) continue;
            met[beyond->second] = 1;
            Triangle next = link[beyond->second];
            while (next[0] != b) std::rotate(next.begin(), next.begin() + 1, next.end());
            queue.push_back({beyond->second, next});
        }
    }
    return ordered;
}

// The first of all orders, so that links of one kind are the same.
std::optional<OrderedLink> in_order(const PointLink& link) {
    std::map<std::array<int, 2>, std::size_t> sides;
    for (std::size_t t = 0; t < link.size(); ++t) {
        for (std::size_t v = 0; v < 3; ++v) {
            if (!sides.try_emplace({link[t][v], link[t][(v + 1) % 3]}, t).second) return std::nullopt;
        }
    }
    std::optional<OrderedLink> best;
    for (std::size_t t = 0; t < link.size(); ++t) {
        for (std::size_t first = 0; first < 3; ++first) {
            OrderedLink ordered = ordered_from(link, sides, t, first);
            if (ordered.link.size() != link.size()) return std::nullopt;
            if (!best || ordered.code < best->code) best = std::move(ordered);
        }
    }
    return best;
}

std::size_t slot_in(const std::array<Index, 8>& cell, Index point) {
    return static_cast<std::size_t>(std::ranges::find(cell, point) - cell.begin());
}

}  // namespace

PointStar::PointStar(const PointLink& link, int reach) : link_(link), reach_(reach) {
    each([&](std::size_t t, const std::array<int, 3>& steps) { numbers_.try_emplace(place_of(t, steps), numbers_.size()); });
}

PointStar::Place PointStar::place_of(std::size_t t, const std::array<int, 3>& steps) const {
    Place place;
    for (std::size_t v = 0; v < 3; ++v) {
        place[v] = steps[v] == 0 ? std::array<int, 2>{-1, 0} : std::array<int, 2>{link_[t][v], steps[v]};
    }
    std::ranges::sort(place);
    return place;
}

std::size_t PointStar::number(std::size_t t, const std::array<int, 3>& steps) const {
    return numbers_.at(place_of(t, steps));
}

std::optional<std::size_t> PointStar::beyond(std::size_t t, std::size_t vertex) const {
    const int a = link_[t][(vertex + 1) % 3], b = link_[t][(vertex + 2) % 3];
    for (std::size_t other = 0; other < link_.size(); ++other) {
        for (std::size_t v = 0; v < 3; ++v) {
            if (link_[other][v] == b && link_[other][(v + 1) % 3] == a) return other;
        }
    }
    return std::nullopt;
}

std::size_t PointStar::valence(int direction) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(link_, [&](const Triangle& t) { return std::ranges::find(t, direction) != t.end(); }));
}

bool PointStar::on_rim(int direction) const {
    for (std::size_t t = 0; t < link_.size(); ++t) {
        for (std::size_t v = 0; v < 3; ++v) {
            if (link_[t][v] != direction && std::ranges::find(link_[t], direction) != link_[t].end() && !beyond(t, v))
                return true;
        }
    }
    return false;
}

std::optional<PointWindow> point_window(const Topology& topology, Index point, Index cell_at_point) {
    constexpr std::size_t kMostCells = 24;
    // Cells at the point, by steps across their sides; then in their order, so that the result does not depend on the first.
    const auto turned = [&](Index cell) {
        const std::size_t corner = slot_in(topology.cells[cell], point);
        return turned_at(topology, cell, corner, kCornerNeighbors[corner]);
    };
    std::vector<Index> cells{cell_at_point};
    bool has_rim = false;
    for (std::size_t n = 0; n < cells.size(); ++n) {
        if (cells.size() > kMostCells) return std::nullopt;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto next = cell_beyond(topology, turned(cells[n]), axis, 0);
            has_rim = has_rim || !next;
            if (next && std::ranges::find(cells, next->cell) == cells.end()) cells.push_back(next->cell);
        }
    }
    std::ranges::sort(cells);
    PointLink raw;
    for (const Index cell : cells) {
        const TurnedCell at = turned(cell);
        raw.push_back({static_cast<int>(at.corners[1]), static_cast<int>(at.corners[2]), static_cast<int>(at.corners[4])});
    }
    if ((topology.point_on_boundary[point] != 0) != has_rim) return std::nullopt;
    // Where bodies touch in the point, these are the cells of one of them, and the point has the rules of both.
    std::vector<int> directions;
    for (const Triangle& triangle : raw) directions.insert(directions.end(), triangle.begin(), triangle.end());
    std::ranges::sort(directions);
    directions.erase(std::unique(directions.begin(), directions.end()), directions.end());
    if (directions.size() != topology.point_edges[point].size()) return std::nullopt;
    for (const Index e : topology.point_edges[point]) {
        if (topology.edge_is_crease[e] != 0) return std::nullopt;
    }
    const auto ordered = in_order(raw);
    if (!ordered) return std::nullopt;
    const PointStar star(ordered->link, PointWindow::kReach);
    for (std::size_t t = 0; t < star.link().size(); ++t) {
        for (const int direction : star.link()[t]) {
            if (star.on_rim(direction) ? star.valence(direction) != 2 : star.valence(direction) < 3) return std::nullopt;
        }
    }
    PointWindow window{ordered->link, std::vector<Index>(star.points(), kNone), {}};
    for (std::size_t t = 0; t < star.link().size(); ++t) {
        const Index cell = cells[ordered->triangles[t]];
        window.cells.push_back(cell);
        std::array<std::size_t, 3> axes{};
        for (std::size_t v = 0; v < 3; ++v) {
            axes[v] = slot_in(topology.cells[cell], static_cast<Index>(ordered->directions[t][v]));
        }
        const TurnedCell first = turned_at(topology, cell, slot_in(topology.cells[cell], point), axes);
        for (int n = 0; n < 8; ++n) {
            std::optional<TurnedCell> at = first;
            for (std::size_t axis = 0; axis < 3 && at; ++axis) {
                if ((n >> axis & 1) != 0) at = cell_beyond(topology, *at, axis, 1);
            }
            if (!at) return std::nullopt;
            for (int k = 0; k < 8; ++k) {
                Index& there =
                    window.points[star.number(t, {(n & 1) + (k & 1), (n >> 1 & 1) + (k >> 1 & 1), (n >> 2) + (k >> 2)})];
                if (there != kNone && there != at->corners[static_cast<std::size_t>(k)]) return std::nullopt;
                there = at->corners[static_cast<std::size_t>(k)];
            }
        }
        for (std::size_t v = 0; v < 3; ++v) {
            const int direction = star.link()[t][v];
            std::array<int, 3> along{}, across{1, 1, 1};
            along[v] = 1;
            across[v] = 0;
            const bool on_rim = star.on_rim(direction);
            const std::size_t valence = star.valence(direction);
            const Index next = window.points[star.number(t, along)], beside = window.points[star.number(t, across)];
            if (!is_regular_point(topology, next, on_rim) && (on_rim || !is_on_straight_edge(topology, next, valence, false))) {
                return std::nullopt;
            }
            if (!is_regular_point(topology, beside, !star.beyond(t, v))) return std::nullopt;
        }
        if (!is_regular_point(topology, window.points[star.number(t, {1, 1, 1})], false)) return std::nullopt;
    }
    return window;
}

PointRules point_rules(Scheme scheme, const PointLink& link) {
    const PointStar coarse(link, 3), fine(link, 6), window(link, PointWindow::kReach);
    HexMesh mesh;
    mesh.points.resize(coarse.points());
    constexpr std::array<std::array<int, 3>, 8> kCorners = kCornerParameters;
    std::vector<std::pair<std::size_t, std::array<int, 3>>> places;  // of the cells
    for (std::size_t t = 0; t < link.size(); ++t) {
        for (int n = 0; n < 27; ++n) {
            const std::array<int, 3> low{n / 9, n / 3 % 3, n % 3};
            std::array<Index, 8> cell{};
            for (std::size_t k = 0; k < 8; ++k) {
                const auto& c = kCorners[k];
                cell[k] = static_cast<Index>(coarse.number(t, {low[0] + c[0], low[1] + c[1], low[2] + c[2]}));
            }
            mesh.cells.push_back(cell);
            places.emplace_back(t, low);
        }
    }
    const RefinementTables tables = refinement_tables(build_topology(mesh), {.scheme = {.kind = scheme}, .levels = 1});
    std::vector<Index> numbers(fine.points(), kNone);
    for (std::size_t c = 0; c < places.size(); ++c) {
        const std::size_t t = places[c].first;
        const auto& low = places[c].second;
        for (std::size_t child = 0; child < 8; ++child) {
            for (std::size_t k = 0; k < 8; ++k) {
                const auto along = [&](std::size_t a) { return 2 * low[a] + kCorners[child][a] + kCorners[k][a]; };
                numbers[fine.number(t, {along(0), along(1), along(2)})] = tables.cells[8 * c + child][k];
            }
        }
    }
    const std::size_t columns = window.points();
    std::vector<double> units(mesh.points.size() * columns, 0.0);
    window.each([&](std::size_t t, const std::array<int, 3>& steps) {
        units[coarse.number(t, steps) * columns + window.number(t, steps)] = 1;
    });
    const std::vector<double> weights = tables.apply(std::span<const double>(units), columns);
    // Adds a point's weights; a negative step leads to the cell beyond, or beyond the boundary, where splines go on straight.
    const auto add = [&](auto& self, auto& rows, Eigen::Index row, std::size_t t, std::array<int, 3> steps, double by) -> void {
        for (std::size_t v = 0; v < 3; ++v) {
            if (steps[v] >= 0) continue;
            const auto other = fine.beyond(t, v);
            if (!other) {
                steps[v] = 0;
                self(self, rows, row, t, steps, 2 * by);
                steps[v] = 1;
                return self(self, rows, row, t, steps, -by);
            }
            std::array<int, 3> there{};
            for (std::size_t n = 0; n < 3; ++n) {
                const int direction = fine.link()[*other][n];
                const auto at = std::ranges::find(link[t], direction) - link[t].begin();
                there[n] = at < 3 ? steps[static_cast<std::size_t>(at)] : -steps[v];
            }
            return self(self, rows, row, *other, there, by);
        }
        const std::size_t from = static_cast<std::size_t>(numbers[fine.number(t, steps)]) * columns;
        for (std::size_t c = 0; c < columns; ++c) rows(row, static_cast<Eigen::Index>(c)) += by * weights[from + c];
    };
    const auto n = static_cast<Eigen::Index>(columns);
    PointRules rules;
    rules.step = Eigen::MatrixXd::Zero(n, n);
    std::vector<std::uint8_t> done(columns, 0);
    window.each([&](std::size_t t, const std::array<int, 3>& steps) {
        const std::size_t row = window.number(t, steps);
        if (done[row] == 0) add(add, rules.step, static_cast<Eigen::Index>(row), t, steps, 1);
        done[row] = 1;
    });
    const auto is_irregular = [&](int direction) { return !window.on_rim(direction) && window.valence(direction) != 4; };
    for (std::size_t t = 0; t < link.size(); ++t) {
        for (int low = 1; low < 8; ++low) {
            const std::array<int, 3> at{low & 1, low >> 1 & 1, low >> 2};
            if (at[0] + at[1] + at[2] == 1 && is_irregular(link[t][at[1] == 1 ? 1 : at[2] == 1 ? 2 : 0])) continue;
            RowsXd rows = RowsXd::Zero(64, n);
            for (int p = 0; p < 64; ++p) {
                add(add, rows, p, t, {at[0] + p / 16 - 1, at[1] + p / 4 % 4 - 1, at[2] + p % 4 - 1}, 1);
            }
            rules.shell.push_back(std::move(rows));
        }
    }
    // From the first octant of each irregular edge round it.
    std::vector<int> met;
    for (std::size_t start = 0; start < link.size(); ++start) {
        for (std::size_t first = 0; first < 3; ++first) {
            const int direction = link[start][first];
            if (!is_irregular(direction) || std::ranges::find(met, direction) != met.end()) continue;
            met.push_back(direction);
            const std::size_t cells = window.valence(direction);
            const Star star{cells, EdgeWindow::kReach};
            PointRules::Segment segment{cells, Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(4 * star.points()), n)};
            std::vector<std::uint8_t> filled(4 * star.points(), 0);
            std::size_t t = start;
            for (std::size_t s = 0; s < cells; ++s) {
                const auto v = static_cast<std::size_t>(std::ranges::find(link[t], direction) - link[t].begin());
                for (int l = 0; l < 4; ++l) {
                    for (int i = 0; i <= 2; ++i) {
                        for (int j = 0; j <= 2; ++j) {
                            const std::size_t row = static_cast<std::size_t>(l) * star.points() + star.number(s, i, j);
                            std::array<int, 3> steps{};
                            steps[v] = l;
                            steps[(v + 1) % 3] = i;
                            steps[(v + 2) % 3] = j;
                            if (filled[row] == 0) add(add, segment.rows, static_cast<Eigen::Index>(row), t, steps, 1);
                            filled[row] = 1;
                        }
                    }
                }
                t = *window.beyond(t, (v + 1) % 3);  // across from the spoke that is left behind
            }
            rules.segments.push_back(std::move(segment));
        }
    }
    return rules;
}

}  // namespace subvol::detail
