// SPDX-License-Identifier: Apache-2.0
// The topology of a refined mesh from that of its parent. Every entity of the child lies in an entity of the parent: a child
// edge halves a parent edge, crosses half a face or half a cell (edges a, b and c of child_numbers.h), a child face is a
// quarter of a face or lies inside a cell. ChildNumbers gives their numbers, so that each member of the child's topology can be
// written at its place, in parallel:
//
//    edges, faces    by their kinds
//    cell_edges,     by the lattice of a refined cell: the two ends of a child edge are places of the 3×3×3 lattice, which name
//    cell_faces      the parent entities that the edge lies in
//    point_edges     the edges from points with smaller numbers, then those from the point itself
//    flags           those of the parent entity; an entity inside a cell is on no boundary
//
// build_topology of the child mesh gives the same bits, at several times the cost: it sorts.
#include "subvol/detail/child_topology.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "child_numbers.h"
#include "subvol/detail/boundary_rings.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

class ChildBuilder {
public:
    explicit ChildBuilder(const Topology& parent) : p_(parent), n_(parent) {}

    Topology build() {
        t_.point_count = n_.first.end;
        t_.cells = child_cells(p_);
        t_.creases = child_creases(p_);
        t_.nonmanifold_edges = 2 * p_.nonmanifold_edges;
        fill_edges();
        fill_faces();
        fill_cells();
        fill_point_edges();
        fill_flags();
        rank_cells();
        fill_child_rings(n_, t_);
        return std::move(t_);
    }

private:
    [[nodiscard]] Index edge_point(Index e) const { return static_cast<Index>(n_.first.edges + e); }
    [[nodiscard]] Index face_point(Index f) const { return static_cast<Index>(n_.first.faces + f); }
    [[nodiscard]] Index cell_point(Index c) const { return static_cast<Index>(n_.first.cells + p_.cell_ordinal[c]); }

    void fill_edges() {
        t_.edges.resize(n_.edge_count());
        parallel_each(p_.edges.size(), [&](std::size_t e) {
            for (std::size_t i = 0; i < 2; ++i)
                t_.edges[n_.at_ends[e][i]] = {p_.edges[e][i], edge_point(static_cast<Index>(e))};
        });
        parallel_each(p_.faces.size(), [&](std::size_t f) {
            for (std::size_t k = 0; k < 4; ++k) {
                t_.edges[n_.to_face[f][k]] = {edge_point(p_.face_edges[f][k]), face_point(static_cast<Index>(f))};
            }
        });
        parallel_each(p_.cells.size(), [&](std::size_t c) {
            for (std::size_t s = 0; s < 6; ++s) {
                t_.edges[n_.to_cell[c][s]] = {face_point(p_.cell_faces[c][s]), cell_point(static_cast<Index>(c))};
            }
        });
        t_.edge_offsets.resize(t_.point_count + 1);
        parallel_each(t_.point_count + 1, [&](std::size_t q) {
            t_.edge_offsets[q] = static_cast<Index>(q < n_.first.edges   ? p_.point_edges.offsets[q]
                                                    : q < n_.first.faces ? n_.edge_b + p_.edge_faces.offsets[q - n_.first.edges]
                                                    : q < n_.first.cells ? n_.edge_c + n_.face_cell_offsets[q - n_.first.faces]
                                                                         : t_.edges.size());
        });
    }

    void fill_faces() {
        const std::size_t count = n_.face_count();
        t_.faces.resize(count);
        t_.face_edges.resize(count);
        t_.face_cells.resize(count);
        if (!p_.face_is_sharp.empty()) t_.face_is_sharp.assign(count, 0);
        parallel_each(p_.faces.size(), [&](std::size_t f) { fill_quarters(static_cast<Index>(f)); });
        parallel_each(p_.cells.size(), [&](std::size_t c) { fill_inner_faces(static_cast<Index>(c)); });
    }

    void fill_quarters(Index f) {
        for (std::size_t k = 0; k < 4; ++k) {
            const Index v = p_.faces[f][k];
            std::size_t low = k, high = (k + 3) % 4;  // slots of its two edges
            if (p_.face_edges[f][high] < p_.face_edges[f][low]) std::swap(low, high);
            const Index e0 = p_.face_edges[f][low], e1 = p_.face_edges[f][high], face = n_.quarters[f][k];
            t_.faces[face] = {v, edge_point(e0), face_point(f), edge_point(e1)};
            t_.face_edges[face] = {n_.at_ends[e0][end_of(e0, v)], n_.to_face[f][low], n_.to_face[f][high],
                                   n_.at_ends[e1][end_of(e1, v)]};
            auto& cells = t_.face_cells[face];
            for (std::size_t i = 0; i < 2; ++i) {
                const Index c = p_.face_cells[f][i];
                cells[i] = c == kNone ? kNone : child_cell(c, slot_of(p_.cells[c], v));
            }
            if (!p_.face_is_sharp.empty()) t_.face_is_sharp[face] = p_.face_is_sharp[f];
        }
    }

    void fill_inner_faces(Index c) {
        for (std::size_t k = 0; k < 12; ++k) {
            const Index e = p_.cell_edges[c][k], face = n_.inner[c][k];
            std::array<std::size_t, 2> side{kEdgeSides[k][0], kEdgeSides[k][1]};
            if (p_.cell_faces[c][side[1]] < p_.cell_faces[c][side[0]]) std::swap(side[0], side[1]);
            const Index f0 = p_.cell_faces[c][side[0]], f1 = p_.cell_faces[c][side[1]];
            t_.faces[face] = {edge_point(e), face_point(f0), cell_point(c), face_point(f1)};
            t_.face_edges[face] = {n_.to_face[f0][slot_of(p_.face_edges[f0], e)], n_.to_cell[c][side[0]],
                                   n_.to_cell[c][side[1]], n_.to_face[f1][slot_of(p_.face_edges[f1], e)]};
            const Index c0 = child_cell(c, kCellEdges[k][0]), c1 = child_cell(c, kCellEdges[k][1]);
            t_.face_cells[face] = {std::min(c0, c1), std::max(c0, c1)};
        }
    }

    [[nodiscard]] std::size_t end_of(Index e, Index v) const { return p_.edges[e][0] == v ? 0 : 1; }

    void fill_cells() {
        t_.cell_edges.resize(t_.cells.size());
        t_.cell_faces.resize(t_.cells.size());
        parallel_each(p_.cells.size(), [&](std::size_t c) {
            for (std::size_t child = 0; child < 8; ++child) fill_cell(static_cast<Index>(c), child);
        });
    }

    void fill_cell(Index c, std::size_t child) {
        const auto& faces = p_.cell_faces[c];
        for (std::size_t k = 0; k < 12; ++k) {
            auto low = lattice_place(child, kCellEdges[k][0]), high = lattice_place(child, kCellEdges[k][1]);
            if (high.kind < low.kind) std::swap(low, high);
            Index& edge = t_.cell_edges[child_cell(c, child)][k];
            if (low.kind == LatticePlace::Corner) {
                const Index e = p_.cell_edges[c][high.number];
                edge = n_.at_ends[e][end_of(e, p_.cells[c][low.number])];
            } else if (low.kind == LatticePlace::Edge) {
                const Index f = faces[high.number];
                edge = n_.to_face[f][slot_of(p_.face_edges[f], p_.cell_edges[c][low.number])];
            } else {
                edge = n_.to_cell[c][low.number];
            }
        }
        for (std::size_t s = 0; s < 6; ++s) {
            // Sides at the child's corner of the parent are quarters of the parent's faces; the other three lie inside it.
            const auto& corners = kCellFaces[s];
            Index& face = t_.cell_faces[child_cell(c, child)][s];
            if (std::find(corners.begin(), corners.end(), child) != corners.end()) {
                face = n_.quarters[faces[s]][slot_of(p_.faces[faces[s]], p_.cells[c][child])];
            } else {
                for (const std::size_t corner : corners) {
                    const auto place = lattice_place(child, corner);
                    if (place.kind == LatticePlace::Edge) face = n_.inner[c][place.number];
                }
            }
        }
    }

    void fill_point_edges() {
        auto& offsets = t_.point_edges.offsets;
        offsets.assign(t_.point_count + 1, 0);
        const auto degree = [&](std::size_t q) {
            if (q < n_.first.edges) return p_.point_edges[q].size();
            if (q < n_.first.faces) return 2 + p_.edge_faces[q - n_.first.edges].size();
            return q < n_.first.cells ? std::size_t{4} + (p_.face_on_hull(static_cast<Index>(q - n_.first.faces)) ? 1 : 2) : 6;
        };
        for (std::size_t q = 0; q < t_.point_count; ++q) offsets[q + 1] = offsets[q] + degree(q);
        auto& values = t_.point_edges.values;
        values.resize(offsets.back());
        const auto put = [&](std::size_t q, auto... edges) {  // ascending: those from smaller points, then its own
            std::size_t i = offsets[q];
            ((values[i++] = edges), ...);
            for (Index e = t_.edge_offsets[q]; e < t_.edge_offsets[q + 1]; ++e) values[i++] = e;
        };
        parallel_each(p_.point_count, [&](std::size_t v) { put(v); });
        parallel_each(p_.edges.size(), [&](std::size_t e) { put(n_.first.edges + e, n_.at_ends[e][0], n_.at_ends[e][1]); });
        parallel_each(p_.faces.size(), [&](std::size_t f) {
            auto b = n_.to_face[f];
            std::sort(b.begin(), b.end());
            put(n_.first.faces + f, b[0], b[1], b[2], b[3]);
        });
        parallel_each(p_.cells.size(), [&](std::size_t c) {
            auto s = n_.to_cell[c];
            std::sort(s.begin(), s.end());
            put(cell_point(static_cast<Index>(c)), s[0], s[1], s[2], s[3], s[4], s[5]);
        });
    }

    void fill_flags() {
        t_.edge_on_boundary.assign(t_.edges.size(), 0);
        t_.edge_is_crease.assign(t_.edges.size(), 0);
        t_.edge_has_ring.assign(t_.edges.size(), 1);
        t_.point_on_boundary.assign(t_.point_count, 0);
        std::copy(p_.point_on_boundary.begin(), p_.point_on_boundary.end(), t_.point_on_boundary.begin());
        parallel_each(p_.edges.size(), [&](std::size_t e) {
            for (const Index half : n_.at_ends[e]) {
                t_.edge_on_boundary[half] = p_.edge_on_boundary[e];
                t_.edge_is_crease[half] = p_.edge_is_crease[e];
                t_.edge_has_ring[half] = p_.edge_has_ring[e];
            }
            t_.point_on_boundary[n_.first.edges + e] = p_.edge_on_boundary[e];
        });
        parallel_each(p_.faces.size(), [&](std::size_t f) {
            const bool boundary = p_.face_on_boundary(static_cast<Index>(f));
            t_.point_on_boundary[n_.first.faces + f] = boundary;
            for (const Index b : n_.to_face[f]) {
                t_.edge_on_boundary[b] = boundary;
                t_.edge_has_ring[b] = !boundary;
            }
        });
    }

    /// Cells are ranked by their sorted faces. The smallest face is a quarter of a parent face, so all cells at one old point
    /// come before those at the next.
    void rank_cells() {
        t_.cell_ordinal.resize(t_.cells.size());
        std::vector<Index> offsets(p_.point_count + 1, 0);
        parallel_each(p_.point_count, [&](std::size_t v) {
            std::size_t sides = 0;  // every cell at the point has three of its faces there
            for (Index q = n_.corner_offsets[v]; q < n_.corner_offsets[v + 1]; ++q) sides += t_.face_on_hull(q) ? 1 : 2;
            offsets[v + 1] = static_cast<Index>(sides / 3);
        });
        for (std::size_t v = 0; v < p_.point_count; ++v) offsets[v + 1] += offsets[v];
        parallel_each(p_.point_count, [&](std::size_t v) {
            Index next = offsets[v];
            for (Index q = n_.corner_offsets[v]; q < n_.corner_offsets[v + 1]; ++q) {
                std::array<Index, 2> cells = t_.face_cells[q];
                std::array<std::array<Index, 6>, 2> keys;
                for (std::size_t i = 0; i < 2; ++i) {
                    if (cells[i] == kNone) continue;
                    keys[i] = t_.cell_faces[cells[i]];
                    std::sort(keys[i].begin(), keys[i].end());
                    if (keys[i][0] != q) cells[i] = kNone;
                }
                if (cells[0] != kNone && cells[1] != kNone && keys[1] < keys[0]) std::swap(cells[0], cells[1]);
                for (const Index c : cells) {
                    if (c != kNone) t_.cell_ordinal[c] = next++;
                }
            }
        });
    }

    const Topology& p_;
    ChildNumbers n_;
    Topology t_;
};

}  // namespace

void check_child(const EntityCounts& parent) {
    const EntityCounts child = child_counts(parent);
    const std::array<std::pair<std::size_t, const char*>, 4> kinds{
        {{child.points, "points"}, {child.edges, "edges"}, {child.faces, "faces"}, {child.cells, "cells"}}};
    const auto& [most, kind] = *std::ranges::max_element(kinds, {}, [](const auto& k) { return k.first; });
    if (most < kNone) return;
    throw Error(ErrorCode::InvalidInput, "the refined mesh needs " + std::to_string(most) + " " + kind, {},
                "at most " + std::to_string(kNone - 1) + ": use fewer levels, or a build with SUBVOL_INDEX64");
}

Topology child_topology(const Topology& parent) {
    check_child({parent.point_count, parent.edges.size(), parent.faces.size(), parent.cells.size()});
    return ChildBuilder(parent).build();
}

}  // namespace subvol::detail
