// SPDX-License-Identifier: Apache-2.0
// A sheet is what a layer of cells is in a grid: the edges that are opposite in the faces of cells, from cell to cell. Every
// mesh of hexahedra consists of sheets, whatever its irregular edges. At a regular point, edges continue each other in lines,
// each from one sheet into the next:
//
//        a ---- v ---- b         v lies between the sheets s and t. If s and t become one sheet, v is no longer needed: it is
//           s      t             predicted from a and b, and from the points beyond them on its line.
//
// In a grid, pairs of layers are joined in all three directions, so that every second point of a line remains and a level has
// an eighth of the points. Where sheets cross each other in an irregular way, the pairs are those that meet at most points.
#include "value_prediction.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "subvol/cell.h"
#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

/// The two neighbours of a point on a line, and the sheets of the edges to them.
struct Line {
    std::array<Index, 2> ends{kNone, kNone};
    std::array<Index, 2> sheets{kNone, kNone};
};

constexpr std::size_t kMostLines = 3;
using Lines = std::array<Line, kMostLines>;

class Builder {
public:
    explicit Builder(std::size_t points) { made_.order.reserve(points); }

    void entry(Index point, int weight) {
        made_.points.push_back(point);
        made_.weights.push_back(static_cast<std::int8_t>(weight));
    }
    void end_row(Index point, std::size_t parts) {
        made_.order.push_back(point);
        made_.offsets.push_back(made_.points.size());
        made_.parts.push_back(static_cast<std::uint8_t>(parts));
    }
    /// A row that repeats the value of the point before.
    void repeat(Index point) {
        if (!made_.order.empty()) entry(made_.order.back(), 1);
        end_row(point, 1);
    }
    [[nodiscard]] ValuePrediction take() { return std::move(made_); }

private:
    ValuePrediction made_;
};

/// For each edge the least edge of its sheet.
std::vector<Index> sheets_of(const Topology& topology) {
    DisjointSets sheets(topology.edges.size());
    for (const auto& edges : topology.cell_edges) {
        for (std::size_t k = 0; k < edges.size(); ++k)
            sheets.join(edges[k / 4 * 4], edges[k]);  // four of `kCellEdges` are parallel
    }
    std::vector<Index> least(topology.edges.size());
    for (Index e = 0; e < least.size(); ++e) least[e] = sheets.least(e);
    return least;
}

bool share_a_cell(const Topology& topology, Index a, Index b) {
    return std::ranges::any_of(topology.edge_cells[a], [&](Index c) {
        return std::ranges::find(topology.cell_edges[c], b) != topology.cell_edges[c].end();
    });
}

/// The lines through each point. Two edges continue each other if neither has another edge at the point with which it shares
/// no cell.
std::vector<Lines> lines_of(const Topology& topology) {
    const std::vector<Index> sheets = sheets_of(topology);
    std::vector<Lines> lines(topology.point_count);
    parallel_each(lines.size(), [&](std::size_t v) {
        const auto edges = topology.point_edges[v];
        const auto opposite = [&](Index e) {
            Index found = kNone;
            for (const Index f : edges) {
                if (f == e || share_a_cell(topology, e, f)) continue;
                if (found != kNone) return kNone;
                found = f;
            }
            return found;
        };
        const auto other_end = [&](Index e) { return topology.edges[e][0] == v ? topology.edges[e][1] : topology.edges[e][0]; };
        std::size_t count = 0;
        for (const Index e : edges) {
            if (count == kMostLines) break;
            const Index f = opposite(e);
            if (f == kNone || f < e || opposite(f) != e) continue;
            lines[v][count++] = {{other_end(e), other_end(f)}, {sheets[e], sheets[f]}};
        }
    });
    return lines;
}

/// The levels, from fine to coarse.
class SheetLevels {
public:
    explicit SheetLevels(const Topology& topology)
        : lines_(lines_of(topology)), alive_(topology.point_count, 1), partner_(topology.edges.size(), kNone) {}

    [[nodiscard]] ValuePrediction predict() {
        std::vector<std::vector<Removed>> levels;
        while (join_sheets()) {
            levels.push_back(removed_points());
            if (levels.back().empty()) break;
            coarsen(levels.back());
        }
        Builder builder(lines_.size());
        for (Index v = 0; v < alive_.size(); ++v) {
            if (alive_[v] != 0) builder.repeat(v);
        }
        for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
            for (const Removed& point : *level) {
                for (std::size_t k = 0; k < point.entries; ++k) builder.entry(point.points[k], point.weights[k]);
                builder.end_row(point.point, 16 * point.lines);
            }
        }
        return builder.take();
    }

private:
    struct Removed {
        Index point = 0;
        std::size_t lines = 0, entries = 0;
        std::array<Index, 4 * kMostLines> points{};
        std::array<int, 4 * kMostLines> weights{};
        void add(Index p, int weight) {
            points[entries] = p;
            weights[entries++] = weight;
        }
    };

    /// Joins each sheet with at most one other, those first that meet at most points. returns: whether there are any
    bool join_sheets() {
        std::ranges::fill(partner_, kNone);
        std::vector<std::array<Index, 2>> meetings;
        for (std::size_t v = 0; v < lines_.size(); ++v) {
            if (alive_[v] == 0) continue;
            for (const Line& line : lines_[v]) {
                const auto [low, high] = std::minmax(line.sheets[0], line.sheets[1]);
                if (line.ends[0] != kNone && line.ends[1] != kNone && low != high) meetings.push_back({low, high});
            }
        }
        std::ranges::sort(meetings);
        struct Pair {
            std::array<Index, 2> sheets;
            std::size_t count;
        };
        std::vector<Pair> pairs;
        for (const auto& meeting : meetings) {
            if (pairs.empty() || pairs.back().sheets != meeting) pairs.push_back({meeting, 0});
            ++pairs.back().count;
        }
        std::ranges::stable_sort(pairs, std::ranges::greater(), &Pair::count);
        for (const Pair& pair : pairs) {
            const auto [a, b] = pair.sheets;
            if (partner_[a] != kNone || partner_[b] != kNone) continue;
            partner_[a] = b;
            partner_[b] = a;
        }
        return !pairs.empty();
    }

    [[nodiscard]] bool crosses_joined(const Line& line) const {
        return line.ends[0] != kNone && line.ends[1] != kNone && partner_[line.sheets[0]] == line.sheets[1];
    }

    /// The point on the line of `a` on the other side of `v`; kNone if there is none.
    [[nodiscard]] Index beyond(Index a, Index v) const {
        if (a == kNone) return kNone;
        for (const Line& line : lines_[a]) {
            if (line.ends[0] == v) return line.ends[1];
            if (line.ends[1] == v) return line.ends[0];
        }
        return kNone;
    }

    /// The points between joined sheets that others predict: those between one pair first, as they predict those between two.
    std::vector<Removed> removed_points() {
        std::array<std::vector<Index>, kMostLines + 1> between;
        std::vector<std::uint8_t> known = alive_;
        for (Index v = 0; v < lines_.size(); ++v) {
            if (alive_[v] == 0) continue;
            const auto pairs = static_cast<std::size_t>(
                std::ranges::count_if(lines_[v], [&](const Line& line) { return crosses_joined(line); }));
            if (pairs == 0) continue;
            between[pairs].push_back(v);
            known[v] = 0;
        }
        const auto is_known = [&](Index p) { return p != kNone && known[p] != 0; };
        std::vector<Removed> removed;
        for (const auto& points : between) {
            for (const Index v : points) {
                Removed row;
                row.point = v;
                for (const Line& line : lines_[v]) {
                    const auto [a, b] = line.ends;
                    if (!crosses_joined(line) || !is_known(a) || !is_known(b)) continue;
                    const Index far_a = beyond(beyond(a, v), a), far_b = beyond(beyond(b, v), b);
                    const bool knows_a = is_known(far_a), knows_b = is_known(far_b);
                    row.add(a, knows_a && knows_b ? 9 : knows_a ? 12 : knows_b ? 6 : 8);
                    row.add(b, knows_a && knows_b ? 9 : knows_a ? 6 : knows_b ? 12 : 8);
                    if (knows_a) row.add(far_a, knows_b ? -1 : -2);
                    if (knows_b) row.add(far_b, knows_a ? -1 : -2);
                    ++row.lines;
                }
                known[v] = 1;
                if (row.lines > 0) removed.push_back(row);
            }
        }
        return removed;
    }

    void coarsen(const std::vector<Removed>& removed) {
        std::vector<std::uint8_t> gone(lines_.size(), 0);
        for (const Removed& point : removed) {
            gone[point.point] = 1;
            alive_[point.point] = 0;
        }
        std::vector<Lines> coarser(lines_.size());
        parallel_each(lines_.size(), [&](std::size_t v) {
            if (alive_[v] == 0) return;
            for (std::size_t l = 0; l < kMostLines; ++l) {
                for (std::size_t k = 0; k < 2; ++k) {
                    Index end = lines_[v][l].ends[k];
                    if (end != kNone && gone[end] != 0) end = beyond(end, static_cast<Index>(v));
                    if (end != kNone && gone[end] != 0) end = kNone;
                    const Index sheet = lines_[v][l].sheets[k];
                    coarser[v][l].ends[k] = end;
                    coarser[v][l].sheets[k] = sheet == kNone ? kNone : std::min(sheet, partner_[sheet]);
                }
            }
        });
        lines_ = std::move(coarser);
    }

    std::vector<Lines> lines_;
    std::vector<std::uint8_t> alive_;
    std::vector<Index> partner_;
};

/// How the corner with an octant is predicted from those whose octants differ in the bits of `mask`.
void predict_corner(const std::array<Index, 8>& cell, std::size_t octant, std::size_t mask, Builder& builder) {
    for (std::size_t bits = 1; bits < 8; ++bits) {
        if ((bits & mask) != bits) continue;
        builder.entry(cell[kCornerOctants[octant ^ bits]], std::popcount(bits) % 2 == 1 ? 1 : -1);
    }
}

}  // namespace

ValuePrediction predict_by_number(std::size_t points) {
    Builder builder(points);
    for (std::size_t p = 0; p < points; ++p) builder.repeat(static_cast<Index>(p));
    return builder.take();
}

ValuePrediction predict_in_cells(const Topology& topology) {
    constexpr std::array<std::size_t, 7> kMasks{7, 3, 5, 6, 1, 2, 4};  // the cell, its faces, its edges
    std::vector<std::uint8_t> known(topology.point_count, 0);
    Builder builder(topology.point_count);
    for (const auto& cell : topology.cells) {
        const auto knows = [&](std::size_t octant) { return known[cell[kCornerOctants[octant]]] != 0; };
        for (;;) {
            std::size_t best = kMasks.size() + 1, corner = 8;
            for (std::size_t octant = 0; octant < 8; ++octant) {
                if (knows(octant)) continue;
                std::size_t way = 0;
                for (; way < kMasks.size(); ++way) {
                    bool all = true;
                    for (std::size_t bits = 1; bits < 8; ++bits) {
                        all = all && ((bits & kMasks[way]) != bits || knows(octant ^ bits));
                    }
                    if (all) break;
                }
                if (way >= best) continue;
                best = way;
                corner = octant;
            }
            if (corner == 8) break;
            const Index v = cell[kCornerOctants[corner]];
            known[v] = 1;
            if (best == kMasks.size()) {
                builder.repeat(v);
                continue;
            }
            predict_corner(cell, corner, kMasks[best], builder);
            builder.end_row(v, 1);
        }
    }
    for (Index v = 0; v < known.size(); ++v) {
        if (known[v] == 0) builder.repeat(v);
    }
    return builder.take();
}

ValuePrediction predict_between_sheets(const Topology& topology) {
    return SheetLevels(topology).predict();
}

}  // namespace subvol::detail
