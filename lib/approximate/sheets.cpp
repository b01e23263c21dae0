// SPDX-License-Identifier: Apache-2.0
#include "sheets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "subvol/cell.h"
#include "subvol/detail/disjoint_sets.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

/// The points of one refinement that the split mesh has, and their numbers there.
///
/// Numbers of one refinement: the points of the mesh, then one for each edge, face and cell, these by `cell_ordinal`.
class SplitPoints {
public:
    SplitPoints(const Topology& topology, std::span<const std::uint8_t> split) : topology_(topology), split_(split) {
        const std::size_t faces = topology.point_count + topology.edges.size(), cells = faces + topology.faces.size();
        numbers_.assign(cells + topology.cells.size(), kNone);
        for (Index p = 0; p < topology.point_count; ++p) add(p);
        for (Index e = 0; e < topology.edges.size(); ++e) {
            if (split[e] != 0) add(topology.point_count + e);
        }
        for (Index f = 0; f < topology.faces.size(); ++f) {
            if (is_split(f, 0) && is_split(f, 1)) add(faces + f);
        }
        for (Index c = 0; c < topology.cells.size(); ++c) {
            const auto ways = ways_of(c);
            if (ways[0] && ways[1] && ways[2]) add(cells + topology.cell_ordinal[c]);
        }
    }

    [[nodiscard]] Index number(std::size_t refined) const { return numbers_[refined]; }
    [[nodiscard]] Index middle(Index edge) const { return numbers_[topology_.point_count + edge]; }
    [[nodiscard]] Index face(Index face) const { return numbers_[topology_.point_count + topology_.edges.size() + face]; }
    [[nodiscard]] const std::vector<std::size_t>& taken() const { return taken_; }

    /// Whether edges k and k + 2 of a face are split.
    [[nodiscard]] bool is_split(Index face, std::size_t k) const { return split_[topology_.face_edges[face][k]] != 0; }

    /// Whether a cell is split along u, v and w.
    [[nodiscard]] std::array<bool, 3> ways_of(Index cell) const {
        const auto& edges = topology_.cell_edges[cell];
        return {split_[edges[0]] != 0, split_[edges[4]] != 0, split_[edges[8]] != 0};
    }

private:
    void add(std::size_t refined) {
        numbers_[refined] = static_cast<Index>(taken_.size());
        taken_.push_back(refined);
    }

    const Topology& topology_;
    std::span<const std::uint8_t> split_;
    std::vector<Index> numbers_;
    std::vector<std::size_t> taken_;
};

/// The new cells, from the children that one refinement has.
void add_cells(SplitMesh& made, const SplitPoints& points, const std::vector<std::array<Index, 8>>& children, Index cell) {
    const std::array<bool, 3> ways = points.ways_of(cell);
    Vec3 size(1.0);
    for (int a = 0; a < 3; ++a) size[a] = ways[static_cast<std::size_t>(a)] ? 0.5 : 1.0;
    // A corner of a part, in halves of the cell, is a corner of the child that has the nearest corner of the cell.
    const auto point = [&](const Vec3& at) {
        std::size_t child = 0, corner = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const double t = at[static_cast<int>(a)];
            child |= (t == 1.0 ? 1u : 0u) << a;
            corner |= (t > 0.0 ? 1u : 0u) << a;
        }
        return points.number(children[8 * cell + kCornerOctants[child]][kCornerOctants[corner]]);
    };
    for (double w = 0; w < 1; w += size.z) {
        for (double v = 0; v < 1; v += size.y) {
            for (double u = 0; u < 1; u += size.x) {
                const CellPart part{cell, {u, v, w}, size};
                auto& corners = made.mesh.cells.emplace_back();
                for (std::size_t c = 0; c < 8; ++c) {
                    const auto& corner = kCornerParameters[c];
                    corners[c] = point(part.lower + part.size * Vec3(corner[0], corner[1], corner[2]));
                }
                made.parts.push_back(part);
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

/// The edge on which an edge goes on beyond an end: the single one that shares no face with it; else kNone.
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

SplitMesh split_sheets(const HexMesh& mesh, const Topology& topology, std::span<const std::uint8_t> edges,
                       const RefineOptions& options) {
    RefineOptions once = options;
    once.levels = 1;
    const RefinementTables tables = refinement_tables(topology, once);
    const std::vector<double> refined =
        tables.apply(std::span<const double>(&mesh.points.front().x, 3 * mesh.points.size()), 3);
    const SplitPoints points(topology, edges);
    SplitMesh made;
    made.mesh.time = mesh.time;
    for (const std::size_t p : points.taken()) {
        // The points of the mesh itself are moved only by a refinement of all that is around them.
        made.mesh.points.push_back(p < mesh.points.size() ? mesh.points[p]
                                                          : Vec3(refined[3 * p], refined[3 * p + 1], refined[3 * p + 2]));
    }
    for (Index c = 0; c < topology.cells.size(); ++c) add_cells(made, points, tables.cells, c);
    add_tags(made.mesh, mesh, topology, points);
    return made;
}

std::vector<LimitQuery> graded_places(const SplitMesh& split, const Topology& topology) {
    const Grading grading(split, topology);
    std::vector<LimitQuery> places(topology.point_count, LimitQuery{kNone, Vec3(0.0)});
    std::vector<std::uint8_t> settled(topology.point_count, 0);
    for (Index c = 0; c < topology.cells.size(); ++c) {
        const CellPart& part = split.parts[c];
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
