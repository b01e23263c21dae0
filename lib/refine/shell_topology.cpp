// SPDX-License-Identifier: Apache-2.0
#include "shell_topology.h"

#include <algorithm>
#include <utility>

namespace subvol::detail {

namespace {

using Edge = std::array<Index, 2>;

Edge edge_of(Index a, Index b) {
    return {std::min(a, b), std::max(a, b)};
}

/// Fills all that follows from sorted edges, each once.
void take_edges(Topology& t, std::vector<Edge> edges) {
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    t.edges.assign(edges.begin(), edges.end());
    const std::size_t count = edges.size();
    t.edge_offsets.assign(t.point_count + 1, 0);
    for (const Edge& e : edges) ++t.edge_offsets[e[0] + 1];
    for (std::size_t p = 0; p < t.point_count; ++p) t.edge_offsets[p + 1] += t.edge_offsets[p];
    t.point_edges.offsets.assign(t.point_count + 1, 0);
    for (const Edge& e : edges) {
        for (const Index p : e) ++t.point_edges.offsets[p + 1];
    }
    for (std::size_t p = 0; p < t.point_count; ++p) t.point_edges.offsets[p + 1] += t.point_edges.offsets[p];
    t.point_edges.values.resize(2 * count);
    std::vector<std::size_t> next(t.point_edges.offsets.begin(), t.point_edges.offsets.end() - 1);
    for (std::size_t e = 0; e < count; ++e) {
        for (const Index p : edges[e]) t.point_edges.values[next[p]++] = static_cast<Index>(e);
    }
    t.edge_faces.offsets.assign(count + 1, 0);
    t.edge_cells.offsets.assign(count + 1, 0);
    t.edge_on_boundary.assign(count, 1);
    t.edge_has_ring.assign(count, 0);
    t.edge_is_crease.assign(count, 1);
    t.point_on_boundary.assign(t.point_count, 1);
}

void take_faces(Topology& t, const std::vector<std::array<Index, 4>>& quads) {
    t.faces.assign(quads.begin(), quads.end());
    t.face_cells.assign(quads.size(), {kNone, kNone});
    t.face_edges.resize(quads.size());
    for (std::size_t f = 0; f < quads.size(); ++f) {
        for (std::size_t k = 0; k < 4; ++k) {
            const Index e = *t.find_edge(quads[f][k], quads[f][(k + 1) % 4]);
            t.face_edges[f][k] = e;
            ++t.edge_faces.offsets[e + 1];
        }
    }
    for (std::size_t e = 0; e < t.edges.size(); ++e) t.edge_faces.offsets[e + 1] += t.edge_faces.offsets[e];
    t.edge_faces.values.resize(4 * quads.size());
    std::vector<std::size_t> next(t.edge_faces.offsets.begin(), t.edge_faces.offsets.end() - 1);
    for (std::size_t f = 0; f < quads.size(); ++f) {
        for (const Index e : t.face_edges[f]) t.edge_faces.values[next[e]++] = static_cast<Index>(f);
    }
}

/// The edge of a face at a point that is not `edge`.
Index other_edge(const Topology& t, Index face, Index point, Index edge) {
    const std::size_t k = slot_of(t.faces[face], point);
    const Index after = t.face_edges[face][k];
    return after == edge ? t.face_edges[face][(k + 3) % 4] : after;
}

/// The faces at a point that can be reached from an edge across edges that are not creases.
std::size_t faces_from(const Topology& t, Index point, Index edge) {
    std::size_t faces = 0;
    Index face = t.edge_faces[edge][0];
    const Index start = edge;
    while (true) {
        ++faces;
        edge = other_edge(t, face, point, edge);
        if (t.edge_is_crease[edge] || edge == start) return faces;
        const auto both = t.edge_faces[edge];
        face = both[0] == face ? both[1] : both[0];
    }
}

PointKind kind_in_shell(const Topology& t, Index point, bool attached, const OnSolid& on_solid) {
    const auto edges = t.point_edges[point];
    std::size_t creases = 0, seams = 0, sides = 0;
    for (const Index e : edges) {
        const std::size_t faces = t.edge_faces[e].size();
        sides += faces;
        if (!t.edge_is_crease[e]) continue;
        ++creases;
        seams += on_solid(t.edges[e][0], t.edges[e][1]) ? 1 : 0;
    }
    const std::size_t faces = sides / 2;
    if (creases == 0) {
        if (attached || faces < 3) return PointKind::Corner;
        return faces_from(t, point, edges[0]) == faces ? PointKind::Smooth : PointKind::Corner;
    }
    if (creases != 2 || faces == 1 || (attached && seams != 2)) return PointKind::Corner;
    // Whether all faces lie in fans between creases: one that is counted from both of its creases is counted twice.
    std::size_t in_fans = 0;
    for (const Index e : edges) {
        if (!t.edge_is_crease[e]) continue;
        for (const Index face : t.edge_faces[e]) {
            Index at = face, edge = e;
            while (true) {
                ++in_fans;
                edge = other_edge(t, at, point, edge);
                if (t.edge_is_crease[edge]) break;
                const auto both = t.edge_faces[edge];
                at = both[0] == at ? both[1] : both[0];
            }
        }
    }
    return in_fans == 2 * faces ? PointKind::Crease : PointKind::Corner;
}

}  // namespace

ShellTopology topology_of_quads(const Shells& shells, const OnSolid& on_solid) {
    ShellTopology result;
    Topology& t = result.topology;
    t.point_count = shells.points.size();
    std::vector<Edge> edges;
    for (const auto& quad : shells.quads) {
        for (std::size_t k = 0; k < 4; ++k) edges.push_back(edge_of(quad[k], quad[(k + 1) % 4]));
    }
    take_edges(t, std::move(edges));
    take_faces(t, shells.quads);
    for (std::size_t e = 0; e < t.edges.size(); ++e) {
        t.edge_is_crease[e] = t.edge_faces[e].size() != 2 || on_solid(t.edges[e][0], t.edges[e][1]);
    }
    for (const auto& [a, b] : shells.lines) {
        if (const auto e = t.find_edge(a, b)) t.edge_is_crease[*e] = 1;
    }
    result.kinds.assign(t.point_count, PointKind::Corner);
    for (Index p = 0; p < t.point_count; ++p) {
        if (t.point_edges[p].empty()) continue;
        result.kinds[p] = kind_in_shell(t, p, shells.solid[p].cell != kNone, on_solid);
    }
    return result;
}

ShellTopology topology_of_lines(const Shells& shells, const Topology& quads) {
    ShellTopology result;
    Topology& t = result.topology;
    t.point_count = shells.points.size();
    std::vector<Edge> edges;
    for (const auto& [a, b] : shells.lines) {
        if (!quads.find_edge(a, b)) edges.push_back(edge_of(a, b));
    }
    take_edges(t, std::move(edges));
    result.kinds.assign(t.point_count, PointKind::Corner);
    for (Index p = 0; p < t.point_count; ++p) {
        const bool held = shells.solid[p].cell != kNone || !quads.point_edges[p].empty();
        if (!held && t.point_edges[p].size() == 2) result.kinds[p] = PointKind::Crease;
    }
    return result;
}

}  // namespace subvol::detail
