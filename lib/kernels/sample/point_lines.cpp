// SPDX-License-Identifier: Apache-2.0
#include "point_lines.h"

#include <algorithm>
#include <bit>

#include "subvol/detail/boundary_rings.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/child_topology.h"

namespace subvol::detail {

namespace {

/// Finds the lines through a point of a mesh, or of its child by the topology of the mesh.
class LineFinder {
public:
    LineFinder(const Topology& topology, bool child)
        : t_(topology), first_(topology), child_(child), kinds_(classify_points(topology)), regular_(regular_points(topology)) {
        cell_of_rank_.resize(child ? topology.cells.size() : 0);
        parallel_each(cell_of_rank_.size(), [&](std::size_t c) { cell_of_rank_[t_.cell_ordinal[c]] = static_cast<Index>(c); });
    }

    [[nodiscard]] std::size_t size() const { return child_ ? first_.end : t_.point_count; }

    /// Calls emit(a, b, cells_a, cells_b) for every line: its neighbours on both sides, kNone where it ends, and how many cells
    /// have the edges to them.
    template <class Emit>
    void at(std::size_t point, const Emit& emit) const {
        if (point < first_.edges) {
            at_vertex(static_cast<Index>(point), emit);
        } else if (point < first_.faces) {
            at_edge(static_cast<Index>(point - first_.edges), emit);
        } else if (point < first_.cells) {
            at_face(static_cast<Index>(point - first_.faces), emit);
        } else {
            at_cell(cell_of_rank_[point - first_.cells], emit);
        }
    }

    /// The number of entries that `at` makes; where it is always 6, without finding the neighbours.
    [[nodiscard]] std::size_t entries(std::size_t point) const {
        if (point >= first_.cells) return 6;
        if (point >= first_.faces && !sharp_inside(static_cast<Index>(point - first_.faces))) return 6;
        if (point >= first_.edges && point < first_.faces && in_full_ring(static_cast<Index>(point - first_.edges))) return 6;
        std::size_t count = 0;
        at(point, [&](Index, Index, unsigned, unsigned) { count += 2; });
        return count;
    }

private:
    [[nodiscard]] bool in_full_ring(Index e) const {
        return !t_.edge_on_boundary[e] && t_.edge_has_ring[e] && t_.edge_faces[e].size() == 4;
    }
    [[nodiscard]] bool sharp_inside(Index f) const { return !t_.face_on_hull(f) && t_.face_on_boundary(f); }

    [[nodiscard]] Index edge_point(Index e) const { return static_cast<Index>(first_.edges + e); }
    [[nodiscard]] Index face_point(Index f) const { return static_cast<Index>(first_.faces + f); }
    [[nodiscard]] Index cell_point(Index c) const {
        return c == kNone ? kNone : static_cast<Index>(first_.cells + t_.cell_ordinal[c]);
    }
    /// At most what fits into a byte: beyond that weights need not be exact.
    [[nodiscard]] unsigned cells_at_edge(Index e) const {
        return static_cast<unsigned>(std::min<std::size_t>(t_.edge_cells[e].size(), 255));
    }
    [[nodiscard]] unsigned cells_at_face(Index f) const { return t_.face_on_hull(f) ? 1 : 2; }

    /// The edge at a vertex that continues another of its edges: the only one that shares no face with it.
    [[nodiscard]] std::size_t opposite(Index vertex, std::size_t slot) const {
        const auto edges = t_.point_edges[vertex];
        if (edges.size() > 64) return kNoSlot;
        std::uint64_t apart = edges.size() == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << edges.size()) - 1;
        apart &= ~(std::uint64_t{1} << slot);
        for (const Index f : t_.edge_faces[edges[slot]]) {
            const std::size_t k = slot_of(t_.faces[f], vertex);
            const Index before = t_.face_edges[f][(k + 3) % 4], after = t_.face_edges[f][k];
            const std::size_t other = slot_of(edges, before == edges[slot] ? after : before);
            apart &= ~(std::uint64_t{1} << other);
        }
        return std::has_single_bit(apart) ? static_cast<std::size_t>(std::countr_zero(apart)) : kNoSlot;
    }

    /// Whether a line may continue through a vertex from one edge to another: not across the boundary or a crease.
    [[nodiscard]] bool passes(Index vertex, Index a, Index b) const {
        switch (kinds_[vertex]) {
            case PointKind::Interior:
                return true;
            case PointKind::Smooth:
                return t_.edge_on_boundary[a] && t_.edge_on_boundary[b];
            case PointKind::Crease:
                return t_.edge_is_crease[a] && t_.edge_is_crease[b];
            case PointKind::Corner:
                return false;
        }
        return false;
    }

    template <class Emit>
    void at_vertex(Index v, const Emit& emit) const {
        const auto edges = t_.point_edges[v];
        const auto neighbour = [&](std::size_t i) { return child_ ? edge_point(edges[i]) : other_end(t_, edges[i], v); };
        for (std::size_t i = 0; i < edges.size(); ++i) {
            const std::size_t j = opposite(v, i);
            const bool pair = j != kNoSlot && passes(v, edges[i], edges[j]) && (regular_[v] || opposite(v, j) == i);
            if (pair && j < i) continue;  // this line was found at the other edge
            if (pair) {
                emit(neighbour(i), neighbour(j), cells_at_edge(edges[i]), cells_at_edge(edges[j]));
            } else {
                emit(neighbour(i), kNone, cells_at_edge(edges[i]), 0u);
            }
        }
    }

    template <class Emit>
    void at_edge(Index e, const Emit& emit) const {
        emit(t_.edges[e][0], t_.edges[e][1], cells_at_edge(e), cells_at_edge(e));
        const auto faces = t_.edge_faces[e];
        const auto pair = [&](Index f, Index g) {
            emit(face_point(f), face_point(g), 2 * cells_at_face(f), 2 * cells_at_face(g));
        };
        if (in_full_ring(e)) {
            pair(faces[0], faces[2]);
            pair(faces[1], faces[3]);
            return;
        }
        const bool smooth = t_.edge_on_boundary[e] && !t_.edge_is_crease[e] && t_.boundary_faces_at(e) == 2;
        const auto [b0, b1] = smooth ? boundary_faces_of(t_, e) : std::pair<Index, Index>{kNone, kNone};
        if (smooth) pair(b0, b1);
        for (const Index f : faces) {
            if (f != b0 && f != b1) emit(face_point(f), kNone, 2 * cells_at_face(f), 0u);
        }
    }

    template <class Emit>
    void at_face(Index f, const Emit& emit) const {
        const auto& e = t_.face_edges[f];
        const unsigned n = 2 * cells_at_face(f);
        emit(edge_point(e[0]), edge_point(e[2]), n, n);
        emit(edge_point(e[1]), edge_point(e[3]), n, n);
        const auto& [c0, c1] = t_.face_cells[f];
        if (sharp_inside(f)) {  // both sides end at it
            emit(cell_point(c0), kNone, 4u, 0u);
            emit(cell_point(c1), kNone, 4u, 0u);
        } else {
            emit(cell_point(c0), cell_point(c1), 4u, c1 == kNone ? 0u : 4u);
        }
    }

    template <class Emit>
    void at_cell(Index c, const Emit& emit) const {
        const auto& f = t_.cell_faces[c];
        for (std::size_t a = 0; a < 3; ++a) emit(face_point(f[2 * a]), face_point(f[2 * a + 1]), 4u, 4u);
    }

    static constexpr std::size_t kNoSlot = ~std::size_t{0};

    const Topology& t_;
    ChildNumbering first_;
    bool child_;
    std::vector<PointKind> kinds_;
    std::vector<std::uint8_t> regular_;
    std::vector<Index> cell_of_rank_;
};

/// Appends the lines of `count` points. point_of(i) is the point i of them for the finder, number_of(p) the number of a point p
/// of the finder in `lines`.
template <class PointOf, class NumberOf>
void append(const LineFinder& finder, std::size_t count, const PointOf& point_of, const NumberOf& number_of,
            PointLines& lines) {
    parallel_each(
        count, [&](std::size_t i) { lines.counts[number_of(point_of(i))] = static_cast<Index>(finder.entries(point_of(i))); });
    std::size_t end = lines.neighbours.size();
    for (std::size_t i = 0; i < count; ++i) {
        const auto p = number_of(point_of(i));
        lines.starts[p] = end;
        end += lines.counts[p];
    }
    lines.neighbours.resize(end);
    lines.cells.resize(end);
    parallel_each(count, [&](std::size_t i) {
        std::size_t at = lines.starts[number_of(point_of(i))];
        finder.at(point_of(i), [&](Index a, Index b, unsigned cells_a, unsigned cells_b) {
            lines.neighbours[at] = a == kNone ? kNone : number_of(a);
            lines.neighbours[at + 1] = b == kNone ? kNone : number_of(b);
            lines.cells[at] = static_cast<std::uint8_t>(cells_a);
            lines.cells[at + 1] = static_cast<std::uint8_t>(cells_b);
            at += 2;
        });
    });
}

}  // namespace

PointLines lines_of_child(const Topology& parent) {
    const LineFinder finder(parent, true);
    PointLines lines;
    lines.starts.resize(finder.size());
    lines.counts.resize(finder.size());
    const auto same = [](auto p) { return static_cast<Index>(p); };
    append(finder, finder.size(), same, same, lines);
    return lines;
}

LinesOfParts::LinesOfParts(std::size_t points) {
    constexpr std::size_t kRegular = 6;  // entries of a point of three lines; memory that stays unused is never touched
    all_.starts.resize(points);
    all_.counts.resize(points);
    all_.neighbours.reserve(kRegular * points);
    all_.cells.reserve(kRegular * points);
}

void LinesOfParts::add(const MeshPart& part) {
    const auto owned = numbers_where<std::vector<Index>>(part.points.size(), [&](std::size_t p) { return part.own[p] != 0; });
    append(
        LineFinder(part.topology, false), owned.size(), [&](std::size_t i) { return owned[i]; },
        [&](Index p) { return part.points[p]; }, all_);
}

}  // namespace subvol::detail
