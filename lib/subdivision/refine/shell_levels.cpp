// SPDX-License-Identifier: Apache-2.0
// Refines shells of quads and lines together with the solid that they are attached to, level by level. An attached point of a
// shell is a corner of a cell, so that its place and values are those of the refined cells; all other points follow the
// scheme's rules for boundary faces and creases. Each level is made in this order:
//
//     1. topology   quads as boundary faces without cells; an edge is a crease if it has other than two quads, lies on an edge
//                   of a cell, or is a line. Lines that are no edges of quads have a topology of their own
//     2. solid      the cells within two layers of the attached points are refined once
//     3. points     old points, then edges and faces of quads, then lines: from a corner of a child of the solid if all their
//                   points are attached and a cell has the same edge or face, else from the rules
//     4. split      each quad into four, each line into two
//
// A point of quads is smooth if it has no creases, is not attached, and its faces form one ring. It is on a crease if it has
// two creases, all its faces lie in fans between them, and both lie on the solid if it is attached. All other points are
// corners.
#include "subvol/detail/shell_levels.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "subvol/cell.h"
#include "subvol/detail/counted_rows.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/detail/schemes.h"
#include "subvol/error.h"

namespace subvol {

namespace detail {

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
    t.point_edges = lists_at_points(edges, t.point_count);
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
            t.face_edges[f][k] = *t.find_edge(quads[f][k], quads[f][(k + 1) % 4]);
        }
    }
    t.edge_faces = lists_at_points(t.face_edges, t.edges.size());
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

namespace {

/// The edges and faces of cells whose points are all attached, by their sorted points of the solid, with the corner of a child
/// that their new point is.
struct SolidParts {
    std::map<std::array<Index, 2>, CellCorner> edges;
    std::map<std::array<Index, 4>, CellCorner> faces;
};

/// The children are those of `chosen` cells: child i of chosen[s] is 8s + i.
SolidParts parts_of(const ShellLevel& level, std::span<const Index> chosen) {
    SolidParts parts;
    std::vector<std::uint8_t> attached(level.solid.points.size(), 0);
    for (const Index p : level.at) {
        if (p != kNone) attached[p] = 1;
    }
    for (std::size_t s = 0; s < chosen.size(); ++s) {
        const auto& cell = level.solid.cells[chosen[s]];
        const auto child = [&](std::size_t i, std::size_t corner) {
            return CellCorner{static_cast<Index>(8 * s + i), static_cast<std::uint8_t>(corner)};
        };
        const auto point = [&](std::size_t corner) { return cell[corner]; };
        for (const auto& [i, j] : kCellEdges) {
            if (attached[point(i)] && attached[point(j)]) {
                parts.edges.try_emplace({std::min(point(i), point(j)), std::max(point(i), point(j))}, child(i, j));
            }
        }
        for (const auto& face : kCellFaces) {
            std::array<Index, 4> key;
            bool all = true;
            for (std::size_t k = 0; k < 4; ++k) {
                key[k] = point(face[k]);
                all = all && attached[key[k]];
            }
            if (!all) continue;
            std::sort(key.begin(), key.end());
            parts.faces.try_emplace(key, child(face[0], face[2]));
        }
    }
    return parts;
}

/// The cells within two layers of the attached points: those that the next level needs.
std::vector<Index> cells_about(const ShellLevel& level) {
    std::vector<std::uint8_t> marked(level.solid.points.size(), 0);
    for (const Index p : level.at) {
        if (p != kNone) marked[p] = 1;
    }
    std::vector<Index> cells;
    for (int layer = 0; layer < 2; ++layer) {
        cells.clear();
        for (Index c = 0; c < level.solid.cells.size(); ++c) {
            const auto& cell = level.solid.cells[c];
            if (std::ranges::any_of(cell, [&](Index p) { return marked[p] != 0; })) cells.push_back(c);
        }
        for (const Index c : cells) {
            for (const Index p : level.solid.cells[c]) marked[p] = 1;
        }
    }
    return cells;
}

/// Points and values of a level that is being made.
struct LevelData {
    const ShellLevel& from;
    Shells& to;

    void add(const StencilRuns& row) {
        Vec3 place(0.0);
        std::size_t next = 0;
        for (const auto& run : row.runs) {
            Vec3 sum(0.0);
            for (std::uint32_t k = 0; k < run.count; ++k) sum += from.shells.points[row.points[next++]];
            place += run.weight * sum;
        }
        to.points.push_back(place);
        to.solid.push_back({});
        for (std::size_t a = 0; a < to.attributes.size(); ++a) {
            const Attribute& attribute = from.shells.attributes[a];
            const auto channels = static_cast<std::size_t>(attribute.channels);
            for (std::size_t c = 0; c < channels; ++c) {
                double value = 0;
                next = 0;
                for (const auto& run : row.runs) {
                    double sum = 0;
                    for (std::uint32_t k = 0; k < run.count; ++k) sum += attribute.values[row.points[next++] * channels + c];
                    value += run.weight * sum;
                }
                to.attributes[a].values.push_back(value);
            }
        }
    }

    /// Takes place and values from the refined cells.
    void add(const HexMesh& solid, const CellCorner& corner, Index whole_cell, std::vector<Index>& at) {
        const Index p = solid.cells[corner.cell][corner.corner];
        to.points.push_back(solid.points[p]);
        to.solid.push_back({whole_cell, corner.corner});
        at[to.points.size() - 1] = p;
        for (std::size_t a = 0; a < to.attributes.size(); ++a) {
            const auto channels = static_cast<std::size_t>(to.attributes[a].channels);
            const auto first = solid.attributes[a].values.data() + p * channels;
            to.attributes[a].values.insert(to.attributes[a].values.end(), first, first + channels);
        }
    }
};

// Makes the next level: points that the mesh has, too, are taken from its refinement, all others are made by the rules.
class NextLevel {
public:
    NextLevel(const ShellLevel& level, const SchemeOptions& scheme)
        : level_(level),
          scheme_(scheme),
          complex_(complex_of(level)),
          quads_(complex_.quads.topology),
          lines_(complex_.lines.topology),
          quad_rules_(make_rules(quads_, scheme, complex_.quads.kinds)),
          line_rules_(make_rules(lines_, scheme, complex_.lines.kinds)),
          first_edge_(level.shells.points.size()),
          first_face_(first_edge_ + quads_.edges.size()),
          first_line_(first_face_ + quads_.faces.size()),
          data_{level, next_.shells} {}

    ShellLevel make() {
        const std::size_t count = first_line_ + lines_.edges.size();
        if (count >= kNone) {
            throw Error(ErrorCode::InvalidInput, "the refined shells need " + std::to_string(count) + " points", {},
                        "at most " + std::to_string(kNone - 1) + ": use fewer levels");
        }
        next_.at.assign(count, kNone);
        for (const Attribute& attribute : level_.shells.attributes) {
            next_.shells.attributes.push_back({attribute.name, attribute.channels, {}});
        }
        refine_solid();
        add_points();
        split();
        return std::move(next_);
    }

private:
    // The cells at the shells, refined once, and the corners of their children at the points that shells share with them.
    void refine_solid() {
        std::vector<Index> chosen;
        if (!level_.solid.cells.empty()) {
            chosen = cells_about(level_);
            next_.solid = refine_cells(level_.solid, chosen, {.scheme = scheme_, .levels = 1});
            for (const Index c : chosen) {
                const std::size_t whole = level_.cells.empty() ? c : level_.cells[c];
                for (std::size_t k = 0; k < 8; ++k) next_.cells.push_back(static_cast<Index>(8 * whole + k));
            }
        }
        parts_ = parts_of(level_, chosen);
        corner_of_.resize(level_.solid.points.size());
        for (std::size_t s = 0; s < chosen.size(); ++s) {
            for (std::uint8_t k = 0; k < 8; ++k) {
                CellCorner& corner = corner_of_[level_.solid.cells[chosen[s]][k]];
                if (corner.cell == kNone) corner = {static_cast<Index>(8 * s + k), k};
            }
        }
    }

    // In the order of their numbers: old points, edges and faces of quads, lines that are not edges of quads.
    void add_points() {
        for (Index p = 0; p < first_edge_; ++p) {
            if (level_.at[p] != kNone) {
                from_solid(corner_of_[level_.at[p]]);
            } else if (!quads_.point_edges[p].empty()) {
                from_rules([&] { quad_rules_->vertex_point(p, row_); });
            } else if (!lines_.point_edges[p].empty()) {
                from_rules([&] { line_rules_->vertex_point(p, row_); });
            } else {
                from_rules([&] { row_.add(p, 1); });
            }
        }
        add_edges(quads_, *quad_rules_);
        for (Index f = 0; f < quads_.faces.size(); ++f) {
            std::array<Index, 4> key;
            for (std::size_t k = 0; k < 4; ++k) key[k] = level_.at[quads_.faces[f][k]];
            std::sort(key.begin(), key.end());
            const auto found = key[3] == kNone ? parts_.faces.end() : parts_.faces.find(key);
            found != parts_.faces.end() ? from_solid(found->second) : from_rules([&] { quad_rules_->face_point(f, row_); });
        }
        add_edges(lines_, *line_rules_);
    }

    template <class Rules>
    void add_edges(const Topology& topology, const Rules& rules) {
        for (Index e = 0; e < topology.edges.size(); ++e) {
            const Index a = level_.at[topology.edges[e][0]], b = level_.at[topology.edges[e][1]];
            const bool attached = a != kNone && b != kNone;
            const auto found = attached ? parts_.edges.find({std::min(a, b), std::max(a, b)}) : parts_.edges.end();
            found != parts_.edges.end() ? from_solid(found->second) : from_rules([&] { rules.edge_point(e, row_); });
        }
    }

    void from_solid(const CellCorner& corner) { data_.add(next_.solid, corner, next_.cells[corner.cell], next_.at); }
    template <class Write>
    void from_rules(const Write& write) {
        row_.clear();
        write();
        data_.add(row_.finish());
    }

    void split() {
        Shells& fine = next_.shells;
        for (std::size_t f = 0; f < quads_.faces.size(); ++f) {
            for (std::size_t k = 0; k < 4; ++k) {
                fine.quads.push_back({quads_.faces[f][k], static_cast<Index>(first_edge_ + quads_.face_edges[f][k]),
                                      static_cast<Index>(first_face_ + f),
                                      static_cast<Index>(first_edge_ + quads_.face_edges[f][(k + 3) % 4])});
            }
        }
        for (const auto& [a, b] : level_.shells.lines) {
            const auto in_shell = quads_.find_edge(a, b);
            const auto middle = static_cast<Index>(in_shell ? first_edge_ + *in_shell : first_line_ + *lines_.find_edge(a, b));
            fine.lines.push_back({a, middle});
            fine.lines.push_back({middle, b});
        }
    }

    const ShellLevel& level_;
    const SchemeOptions& scheme_;
    ShellComplex complex_;
    const Topology &quads_, &lines_;
    std::unique_ptr<SchemeRules> quad_rules_, line_rules_;
    std::size_t first_edge_, first_face_, first_line_;  // numbers of the first points of each kind
    ShellLevel next_;
    LevelData data_;
    SolidParts parts_;
    std::vector<CellCorner> corner_of_;  // the corner of a child at each point of the mesh that a shell has
    StencilBuilder row_;
};

}  // namespace

ShellComplex complex_of(const ShellLevel& level) {
    std::vector<Index> all(level.solid.cells.size());
    for (Index c = 0; c < all.size(); ++c) all[c] = c;
    const SolidParts parts = parts_of(level, all);
    const auto on_solid = [&](Index p, Index q) {
        const Index a = level.at[p], b = level.at[q];
        return a != kNone && b != kNone && parts.edges.contains({std::min(a, b), std::max(a, b)});
    };
    ShellComplex complex;
    complex.quads = topology_of_quads(level.shells, on_solid);
    complex.lines = topology_of_lines(level.shells, complex.quads.topology);
    return complex;
}

ShellLevel refine_shell_level(const HexMesh& mesh, const Shells& shells, const RefineOptions& options) {
    check_levels(options.levels);
    validate(shells, mesh);
    ShellLevel level;
    level.shells = shells;
    level.at.assign(shells.points.size(), kNone);
    const bool attached = std::ranges::any_of(shells.solid, [](const CellCorner& corner) { return corner.cell != kNone; });
    if (attached) {
        level.solid = control_mesh(mesh, options.scheme, options.levels);
        for (std::size_t p = 0; p < shells.points.size(); ++p) {
            const auto& [cell, corner] = shells.solid[p];
            if (cell != kNone) level.at[p] = level.solid.cells[cell][corner];
        }
    }
    SchemeOptions scheme = options.scheme;
    scheme.crease_angle_deg.reset();  // they are found once, in the control mesh
    for (int l = 0; l < options.levels; ++l) {
        report_progress(options.progress, "shells", static_cast<double>(l) / options.levels);
        level = NextLevel(level, scheme).make();
    }
    return level;
}

}  // namespace detail

Shells refine_shells(const HexMesh& mesh, const Shells& shells, const RefineOptions& options) {
    return detail::refine_shell_level(mesh, shells, options).shells;
}

}  // namespace subvol
