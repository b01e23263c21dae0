// SPDX-License-Identifier: Apache-2.0
#include "shell_levels.h"

#include <algorithm>
#include <map>
#include <memory>

#include "refine_steps.h"
#include "schemes.h"
#include "subvol/cell.h"
#include "subvol/error.h"

namespace subvol {

namespace detail {

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
        const auto child = [&](int i, int corner) {
            return CellCorner{static_cast<Index>(8 * s + static_cast<std::size_t>(i)), static_cast<std::uint8_t>(corner)};
        };
        const auto point = [&](int corner) { return cell[static_cast<std::size_t>(corner)]; };
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
        for (std::size_t c = 0; c < level.solid.cells.size(); ++c) {
            const auto& cell = level.solid.cells[c];
            if (std::ranges::any_of(cell, [&](Index p) { return marked[p] != 0; })) cells.push_back(static_cast<Index>(c));
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
            const auto first = solid.attributes[a].values.begin() + static_cast<std::ptrdiff_t>(p * channels);
            to.attributes[a].values.insert(to.attributes[a].values.end(), first, first + static_cast<std::ptrdiff_t>(channels));
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
    for (std::size_t c = 0; c < all.size(); ++c) all[c] = static_cast<Index>(c);
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
