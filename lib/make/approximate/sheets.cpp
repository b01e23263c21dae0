// SPDX-License-Identifier: Apache-2.0
// More control points where they are asked for, by splitting sheets of cells.
//
// Which sheets: the edges of a sheet are joined from side to opposite side of every face. A cell that asks chooses the
// direction in which the control values bend most, and others with at least half as much; the sheets of its edges along these
// are split as a whole.
//
// Splitting: every edge of such a sheet gets a point, every face and cell a further one where it is split along all its
// directions. A cell becomes 1, 2, 4 or 8 parts, each with its place in the cell. Creases and sharp faces are split likewise.
//
// Grading: halves beside wholes would be a jump. The length l of an edge, in parameters of the cell that was split, moves in
// four passes towards those l' beyond its ends, by (l' − l) / 4 for each, and its ends move as much. A point's place is noted
// in the cell into which it moves along all three edges, if there is one.
#include "sheets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "subvol/cell.h"
#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

/// The points of the split mesh: those of the mesh, then one for each edge, face and cell that is split along all its
/// directions.
class SplitPoints {
public:
    SplitPoints(const Topology& topology, std::span<const std::uint8_t> split)
        : topology_(topology),
          split_(split),
          count_(topology.point_count),
          edges_(topology.edges.size(), kNone),
          faces_(topology.faces.size(), kNone),
          cells_(topology.cells.size(), kNone) {
        for (Index e = 0; e < edges_.size(); ++e) {
            if (split[e] != 0) edges_[e] = static_cast<Index>(count_++);
        }
        for (Index f = 0; f < faces_.size(); ++f) {
            if (is_split(f, 0) && is_split(f, 1)) faces_[f] = static_cast<Index>(count_++);
        }
        for (Index c = 0; c < cells_.size(); ++c) {
            if (steps_of(c) == std::array{1, 1, 1}) cells_[c] = static_cast<Index>(count_++);
        }
    }

    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] Index middle(Index edge) const { return edges_[edge]; }
    [[nodiscard]] Index face(Index face) const { return faces_[face]; }

    /// Whether edges k and k + 2 of a face are split.
    [[nodiscard]] bool is_split(Index face, std::size_t k) const { return split_[topology_.face_edges[face][k]] != 0; }

    /// The size of the parts of a cell along u, v and w, in halves of the cell.
    [[nodiscard]] std::array<int, 3> steps_of(Index cell) const {
        const auto& edges = topology_.cell_edges[cell];
        return {split_[edges[0]] != 0 ? 1 : 2, split_[edges[4]] != 0 ? 1 : 2, split_[edges[8]] != 0 ? 1 : 2};
    }

    /// The point of a cell at so many halves of it along u, v and w.
    [[nodiscard]] Index at(Index cell, const std::array<int, 3>& halves) const {
        const auto middles = std::ranges::count(halves, 1);
        if (middles == 3) return cells_[cell];
        if (middles == 2) {
            const std::size_t a = halves[0] != 1 ? 0 : halves[1] != 1 ? 1 : 2;
            return faces_[topology_.cell_faces[cell][2 * a + (halves[a] == 2 ? 1 : 0)]];
        }
        const auto is_at = [&](std::size_t corner) {
            for (std::size_t a = 0; a < 3; ++a) {
                if (halves[a] != 1 && halves[a] != 2 * kCornerParameters[corner][a]) return false;
            }
            return true;
        };
        if (middles == 0) {
            std::size_t corner = 0;
            while (!is_at(corner)) ++corner;
            return topology_.cells[cell][corner];
        }
        std::size_t edge = 0;
        while (!is_at(kCellEdges[edge][0]) || !is_at(kCellEdges[edge][1])) ++edge;
        return edges_[topology_.cell_edges[cell][edge]];
    }

private:
    const Topology& topology_;
    std::span<const std::uint8_t> split_;
    std::size_t count_;
    std::vector<Index> edges_, faces_, cells_;
};

void add_cells(SplitMesh& made, const SplitPoints& points, Index cell) {
    const std::array<int, 3> size = points.steps_of(cell);
    for (int w = 0; w < 2; w += size[2]) {
        for (int v = 0; v < 2; v += size[1]) {
            for (int u = 0; u < 2; u += size[0]) {
                auto& corners = made.mesh.cells.emplace_back();
                for (std::size_t c = 0; c < 8; ++c) {
                    const auto& at = kCornerParameters[c];
                    corners[c] = points.at(cell, {u + at[0] * size[0], v + at[1] * size[1], w + at[2] * size[2]});
                }
                made.parts.push_back({cell, Vec3(u, v, w) / 2.0, Vec3(size[0], size[1], size[2]) / 2.0});
            }
        }
    }
}

/// The tags of the mesh at the edges and faces that lie in theirs.
void add_tags(HexMesh& made, const HexMesh& mesh, const Topology& topology, const SplitPoints& points) {
    for (const auto& [a, b] : mesh.creases) {
        const Index middle = points.middle(*topology.find_edge(a, b));
        if (middle == kNone) {
            made.creases.push_back({a, b});
        } else {
            made.creases.push_back({a, middle});
            made.creases.push_back({b, middle});
        }
    }
    for (const auto& sharp : mesh.sharp_faces) {
        const Index f = *topology.find_face(sharp);
        const auto& corners = topology.faces[f];
        const auto middle = [&](std::size_t k) { return points.middle(topology.face_edges[f][k % 4]); };
        if (points.is_split(f, 0) && points.is_split(f, 1)) {
            for (std::size_t k = 0; k < 4; ++k)
                made.sharp_faces.push_back({corners[k], middle(k), points.face(f), middle(k + 3)});
        } else if (points.is_split(f, 0) || points.is_split(f, 1)) {
            const std::size_t k = points.is_split(f, 0) ? 0 : 1;  // its edges k and k + 2 are split
            made.sharp_faces.push_back({corners[k], middle(k), middle(k + 2), corners[(k + 3) % 4]});
            made.sharp_faces.push_back({middle(k), corners[k + 1], corners[(k + 2) % 4], middle(k + 2)});
        } else {
            made.sharp_faces.push_back(corners);
        }
    }
}

/// The point there.
Index beyond(const Topology& topology, Index edge, Index end) {
    const Index next = edge_beyond(topology, edge, end);
    if (next == kNone) return kNone;
    const auto& [a, b] = topology.edges[next];
    return a == end ? b : a;
}

/// How far points move along edges so that the lengths of these, in parameters of the mesh that was split, change step by step.
class Grading {
public:
    Grading(const SplitMesh& split, const Topology& topology) : topology_(topology), ends_(topology.edges.size(), {0.0, 0.0}) {
        std::vector<double> lengths(topology.edges.size());
        for (Index c = 0; c < topology.cells.size(); ++c) {
            for (std::size_t e = 0; e < kCellEdges.size(); ++e)
                lengths[topology.cell_edges[c][e]] = split.parts[c].size[static_cast<int>(e / 4)];
        }
        std::vector<std::array<Index, 2>> beyond_ends(topology.edges.size());
        parallel_each(beyond_ends.size(), [&](std::size_t e) {
            for (std::size_t k = 0; k < 2; ++k)
                beyond_ends[e][k] = edge_beyond(topology, static_cast<Index>(e), topology.edges[e][k]);
        });
        constexpr int kPasses = 4;
        for (int pass = 0; pass < kPasses; ++pass) {
            std::vector<double> next = lengths;
            parallel_each(next.size(), [&](std::size_t e) {
                for (std::size_t k = 0; k < 2; ++k) {
                    if (beyond_ends[e][k] == kNone) continue;
                    const double out = (lengths[beyond_ends[e][k]] - lengths[e]) / 4;
                    next[e] += out;
                    ends_[e][k] -= out;
                }
            });
            lengths = std::move(next);
        }
    }

    /// How far a point moves into an edge of which it is an end; below 0: away from it.
    [[nodiscard]] double way_along(Index edge, Index point) const {
        return ends_[edge][topology_.edges[edge][0] == point ? 0 : 1];
    }

private:
    const Topology& topology_;
    std::vector<std::array<double, 2>> ends_;
};

/// How much the fields bend along an edge. With a single edge beyond one end alone it is the second difference there; without
/// any, the difference along the edge.
double bend_along(const HexMesh& mesh, const Topology& topology, Index edge, std::span<const double> ranges) {
    const auto& [b, c] = topology.edges[edge];
    const Index a = beyond(topology, edge, b), d = beyond(topology, edge, c);
    double most = 0;
    for (std::size_t f = 0; f < ranges.size(); ++f) {
        const auto channels = static_cast<std::size_t>(mesh.attributes[f].channels);
        for (std::size_t k = 0; k < channels && ranges[f] > 0; ++k) {
            const auto value = [&](Index p) { return mesh.attributes[f].values[p * channels + k]; };
            const double step = value(c) - value(b);
            const double before = a == kNone ? step : value(b) - value(a), after = d == kNone ? step : value(d) - value(c);
            const double bend = a == kNone && d == kNone ? step : after - before;
            most = std::max(most, std::abs(bend) / ranges[f]);
        }
    }
    return most;
}

}  // namespace

Index edge_beyond(const Topology& topology, Index edge, Index end) {
    Index found = kNone;
    for (const Index other : topology.point_edges[end]) {
        if (other == edge) continue;
        const bool turns = std::ranges::any_of(topology.edge_faces[edge], [&](Index f) {
            return std::ranges::find(topology.face_edges[f], other) != topology.face_edges[f].end();
        });
        if (turns) continue;
        if (found != kNone) return kNone;
        found = other;
    }
    return found;
}

std::vector<std::uint8_t> edges_to_split(const HexMesh& mesh, const Topology& topology, std::span<const std::uint8_t> cells) {
    DisjointSets sheets(topology.edges.size());
    for (const auto& edges : topology.face_edges) {
        sheets.join(edges[0], edges[2]);
        sheets.join(edges[1], edges[3]);
    }
    std::vector<double> ranges;
    for (const Attribute& field : mesh.attributes) {
        const auto [low, high] = std::ranges::minmax(field.values);
        ranges.push_back(high - low);
    }
    std::vector<std::uint8_t> asked(topology.edges.size(), 0);
    for (Index c = 0; c < cells.size(); ++c) {
        if (cells[c] == 0) continue;
        const auto& edges = topology.cell_edges[c];  // four along each direction
        std::array<double, 3> bends{};
        for (std::size_t e = 0; e < edges.size(); ++e)
            bends[e / 4] = std::max(bends[e / 4], bend_along(mesh, topology, edges[e], ranges));
        constexpr double kMuch = 0.5;
        const double most = std::ranges::max(bends);
        for (std::size_t a = 0; a < 3; ++a) {
            if (bends[a] >= kMuch * most) asked[sheets.least(edges[4 * a])] = 1;
        }
    }
    std::vector<std::uint8_t> split(asked.size());
    for (Index e = 0; e < split.size(); ++e) split[e] = asked[sheets.least(e)];
    return split;
}

SplitMesh split_sheets(const HexMesh& mesh, const Topology& topology, std::span<const std::uint8_t> edges) {
    const SplitPoints points(topology, edges);
    SplitMesh made;
    made.mesh.time = mesh.time;
    made.mesh.points = mesh.points;
    made.mesh.points.resize(points.count());
    for (Index c = 0; c < topology.cells.size(); ++c) add_cells(made, points, c);
    add_tags(made.mesh, mesh, topology, points);
    return made;
}

std::vector<LimitQuery> graded_places(const SplitMesh& split, const Topology& topology) {
    const Grading grading(split, topology);
    std::vector<LimitQuery> places(topology.point_count, LimitQuery{kNone, Vec3(0.0)});
    std::vector<std::uint8_t> settled(topology.point_count, 0);
    for (Index c = 0; c < topology.cells.size(); ++c) {
        const PartOfCell& part = split.parts[c];
        for (std::size_t corner = 0; corner < 8; ++corner) {
            const Index point = topology.cells[c][corner];
            if (settled[point] != 0) continue;
            // The cell into which the point moves along all three edges: at a point that stays, the first one.
            Vec3 ways(0.0);
            for (std::size_t e = 0; e < kCellEdges.size(); ++e) {
                const auto a = static_cast<int>(e / 4);
                if (kCellEdges[e][0] == corner || kCellEdges[e][1] == corner)
                    ways[a] = grading.way_along(topology.cell_edges[c][e], point) / part.size[a];
            }
            const bool inwards = std::min({ways.x, ways.y, ways.z}) >= 0;
            if (places[point].cell != kNone && !inwards) continue;
            settled[point] = inwards ? 1 : 0;
            const auto& at = kCornerParameters[corner];
            const Vec3 lower(at[0], at[1], at[2]);
            constexpr double kMost = 0.9;
            const Vec3 in_part =
                inwards ? glm::mix(glm::min(ways, Vec3(kMost)), 1.0 - glm::min(ways, Vec3(kMost)), lower) : lower;
            places[point] = {part.parent, part.lower + part.size * in_part};
        }
    }
    return places;
}

}  // namespace subvol::detail
