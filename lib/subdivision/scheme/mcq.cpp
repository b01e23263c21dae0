// SPDX-License-Identifier: Apache-2.0
// MCQ-G: interpolatory subdivision of hexahedral meshes. Inside a grid it is MCQ [mcq2004, mnmq2007]; the rules at irregular
// edges, boundaries and creases are ours (docs/schemes.md). Old points stay where they are. ω is the tension, 1/16 by default.
//
//    r ── q ── q ── r     The new point x of edge ab in a grid, in one of the two planes through the edge:
//    │    │    │    │
//    ○ ── a ─x─ b ── ○       x = 1/2 Σ{a,b} + ω/4 Σ q − ω/4 Σ r   over 8 points q and 8 points r
//    │    │    │    │
//    r ── q ── q ── r     The points q lie across the faces of the edge, the points r one step further along the edge.
//
// Points of faces and cells follow the same pattern (`regular_face`, `regular_cell`). Elsewhere "one step further" has no
// unique meaning. Across an edge with a ring of m faces it is the antipodal term: the sum over the ring with the weights c_j of
// antipode.h, which for m = 4 is the face opposite; for large m it is two sums over the ring (ring_sums.h). Beyond a boundary
// it is a ghost: the quadratic extrapolation from the points on this side and the term at the opposite end of the line.
#include <algorithm>

#include "antipode.h"
#include "opposites.h"
#include "subvol/detail/incident.h"
#include "subvol/detail/ring_sums.h"
#include "subvol/detail/schemes.h"

namespace subvol::detail {

namespace {

class McqRules final : public SchemeRules {
public:
    McqRules(const Topology& topology, double tension, std::vector<PointKind> kinds)
        : topology_(topology),
          omega_(tension),
          kinds_(std::move(kinds)),
          regular_(regular_points(topology)),
          sums_(topology.point_count) {}

    const RingSums* use_ring_sums() override {
        for (Index e = 0; e < topology_.edges.size(); ++e) {
            const auto ring = topology_.edge_faces[e];
            if (ring.size() < RingSums::kLong || !topology_.edge_has_ring[e]) continue;
            std::array<std::vector<Index>, 2> points;
            for (const Index face : ring) {
                const Pair at_ends = far_side(topology_, face, e);
                for (std::size_t end = 0; end < 2; ++end) points[end].push_back(at_ends[end]);
            }
            sums_.add(about_edge(e), ring, points);
        }
        std::vector<Index> ring;
        for (Index p = 0; p < topology_.point_count; ++p) {
            if (kinds_[p] != PointKind::Smooth || topology_.point_edges[p].size() < RingSums::kLong) continue;
            const auto edges = topology_.point_edges[p];
            ring_of_spokes(topology_, p, *std::ranges::find_if(edges, [&](Index e) { return topology_.edge_on_boundary[e]; }),
                           ring);
            if (ring.size() < RingSums::kLong) continue;
            std::vector<Index> ends;
            for (const Index e : ring) ends.push_back(other_end(topology_, e, p));
            sums_.add(about_point(p), ring, std::span(&ends, 1));
        }
        return sums_.empty() ? nullptr : &sums_;
    }

    void edge_point(Index edge, StencilBuilder& row) const override {
        const auto [a, b] = topology_.edges[edge];
        if (regular_[a] && regular_[b]) {
            regular_edge(edge, row);
        } else if (!topology_.edge_on_boundary[edge]) {
            interior_edge(edge, row);
        } else if (topology_.edge_is_crease[edge]) {
            crease_edge(edge, row);
        } else {
            surface_edge(edge, row);
        }
    }

    void face_point(Index face, StencilBuilder& row) const override {
        const auto& [a, b, c, d] = topology_.faces[face];
        if (regular_[a] && regular_[b] && regular_[c] && regular_[d]) {
            regular_face(face, row);
        } else if (topology_.face_on_boundary(face)) {
            surface_face(face, row);
        } else {
            interior_face(face, row);
        }
    }

    void cell_point(Index cell, StencilBuilder& row) const override {
        const auto& sides = topology_.cell_faces[cell];
        if (std::none_of(sides.begin(), sides.end(), [&](Index f) { return topology_.face_on_boundary(f); })) {
            regular_cell(cell, row);
        } else {
            interior_cell(cell, row);
        }
    }

private:
    // Rules in a grid: whole runs of equal weights.

    void regular_edge(Index edge, StencilBuilder& row) const {
        const auto [a, b] = topology_.edges[edge];
        std::array<Index, 8> q, r;
        std::size_t k = 0;
        for (const Index face : topology_.edge_faces[edge]) {
            q[k++] = across_face(topology_, face, a);
            q[k++] = across_face(topology_, face, b);
        }
        k = 0;
        for (const Index end : {a, b}) {  // beyond an end, the faces of the edge that continues this one
            for (const Index face : topology_.edge_faces[continuation(edge, end)]) r[k++] = across_face(topology_, face, end);
        }
        row.add_run(topology_.edges[edge], 0.5);
        row.add_run(q, omega_ / 4);
        row.add_run(r, -omega_ / 4);
    }

    void regular_face(Index face, StencilBuilder& row) const {
        std::array<Index, 8> q, r;
        std::array<Index, 16> s;
        std::size_t k = 0;
        const auto& corners = topology_.faces[face];
        for (const Index cell : topology_.face_cells[face]) {
            for (const Index p : corners) q[k++] = across_cell(topology_, cell, p);
        }
        std::size_t in_r = 0, in_s = 0;
        for (std::size_t side = 0; side < 4; ++side) {
            const Index g = topology_.face_edges[face][side];
            const auto ring = topology_.edge_faces[g];
            const auto cells = topology_.edge_cells[g];
            const std::size_t start = slot_of(ring, face);
            for (const Index p : {corners[side], corners[(side + 1) % 4]}) {
                r[in_r++] = across_face(topology_, ring[(start + 2) % 4], p);
                s[in_s++] = across_cell(topology_, cells[(start + 1) % 4], p);
                s[in_s++] = across_cell(topology_, cells[(start + 2) % 4], p);
            }
        }
        row.add_run(topology_.faces[face], (1 + 2 * omega_) / 4);
        row.add_run(q, omega_ / 4);
        row.add_run(r, -omega_ / 4);
        row.add_run(s, -omega_ / 8);
    }

    void regular_cell(Index cell, StencilBuilder& row) const {
        std::array<Index, 24> q;
        std::size_t k = 0;
        for (std::size_t side = 0; side < 6; ++side) {
            const auto [c0, c1] = topology_.face_cells[topology_.cell_faces[cell][side]];
            for (const Index p : side_points(topology_, cell, side)) q[k++] = across_cell(topology_, c0 == cell ? c1 : c0, p);
        }
        row.add_run(topology_.cells[cell], (1 + 6 * omega_) / 8);
        row.add_run(q, -omega_ / 4);
    }

    /// The edge that continues this one beyond a regular end: the only one of the six there that shares no face with it.
    Index continuation(Index edge, Index end) const {
        Index left = edge;
        for (const Index e : topology_.point_edges[end]) left ^= e;
        for (const Index face : topology_.edge_faces[edge]) {
            const auto& quad = topology_.faces[face];
            const std::size_t k = slot_of(quad, end);
            const Index before = topology_.face_edges[face][(k + 3) % 4], after = topology_.face_edges[face][k];
            left ^= before == edge ? after : before;
        }
        return left;
    }

    // Rules everywhere else. A term is a function that adds itself to a row with a given weight. It adds nothing and returns
    // false where the mesh ends before the points that it needs.

    template <class Points>
    static void add(StencilBuilder& row, const Points& points, double weight) {
        for (const Index p : points) row.add(p, weight);
    }

    /// Adds weight · term, or its ghost where the mesh ends: 3 near − 3 far + partner; 2 near − far without a partner.
    template <class Points, class Term, class Partner>
    static void extrapolated(StencilBuilder& row, double weight, const Points& near, const Points& far, const Term& term,
                             const Partner& partner) {
        if (term(row, weight)) return;
        const bool quadratic = partner(row, weight);
        add(row, near, quadratic ? 3 * weight : 2 * weight);
        add(row, far, quadratic ? -3 * weight : -weight);
    }

    /// Adds the two terms beyond the ends of a line; each is the partner of the other.
    template <class TermA, class TermB>
    static void both_ways(StencilBuilder& row, double weight, Index near_a, Index near_b, const TermA& beyond_a,
                          const TermB& beyond_b) {
        const std::array<Index, 1> a{near_a}, b{near_b};
        extrapolated(row, weight, a, b, beyond_a, beyond_b);
        extrapolated(row, weight, b, a, beyond_b, beyond_a);
    }

    /// The antipodal term across the edge from a to d: the neighbours of d in the ring of faces about that edge.
    [[nodiscard]] auto across_edge(Index face, Index a, Index d) const {
        return [=, this](StencilBuilder& row, double weight) {
            const Index edge = edge_in_face(topology_, face, a, d);
            if (!topology_.edge_has_ring[edge]) return false;
            const auto ring = topology_.edge_faces[edge];
            if (has_sums(edge)) {
                row.add(beside(topology_, face, d, a), weight);
                sums_.add_terms(about_edge(edge), face, topology_.edges[edge][0] == d ? 0 : 1, weight, row);
                return true;
            }
            const std::size_t m = ring.size(), start = slot_of(ring, face);
            for (std::size_t j = 0; j < m; ++j) {
                const double c = antipodal_(m, j);
                if (c != 0) row.add(beside(topology_, ring[(start + j) % m], d, a), c * weight);
            }
            return true;
        };
    }

    /// The antipodal term across an edge of a face: the two points of each face of its ring that are not on the edge.
    [[nodiscard]] auto in_plane(Index face, Index edge) const {
        return [=, this](StencilBuilder& row, double weight) {
            if (!topology_.edge_has_ring[edge]) return false;
            const auto ring = topology_.edge_faces[edge];
            if (has_sums(edge)) {
                add(row, far_side(topology_, face, edge), weight);
                for (std::size_t end = 0; end < 2; ++end) sums_.add_terms(about_edge(edge), face, end, weight, row);
                return true;
            }
            const std::size_t m = ring.size(), start = slot_of(ring, face);
            for (std::size_t j = 0; j < m; ++j) {
                const double c = antipodal_(m, j);
                if (c == 0) continue;
                for (const Index p : far_side(topology_, ring[(start + j) % m], edge)) row.add(p, c * weight);
            }
            return true;
        };
    }

    /// Beyond an edge of a face, over and under its plane: in the cells next to the two cells of the face, the two points
    /// diagonally opposite the edge.
    [[nodiscard]] auto diagonal(Index face, Index edge) const {
        return [=, this](StencilBuilder& row, double weight) {
            if (!topology_.edge_has_ring[edge]) return false;
            const auto faces = topology_.edge_faces[edge];
            const auto cells = topology_.edge_cells[edge];
            const std::size_t m = faces.size();
            const std::size_t start = has_sums(edge) ? sums_.slot(about_edge(edge), face) : slot_of(faces, face);
            for (const std::size_t j : {std::size_t{1}, m - 2}) {
                for (const Index p : opposite_edge(topology_, cells[(start + j) % m], edge)) row.add(p, weight);
            }
            return true;
        };
    }

    /// The far points of the neighbour across a side of a cell.
    [[nodiscard]] auto far_points(Index cell, std::size_t side) const {
        return [=, this](StencilBuilder& row, double weight) {
            const Index face = topology_.cell_faces[cell][side];
            if (topology_.face_on_boundary(face)) return false;
            const auto [c0, c1] = topology_.face_cells[face];
            add(row, opposite_points(topology_, c0 == cell ? c1 : c0, face), weight);
            return true;
        };
    }

    /// The far end of the other crease edge at a.
    [[nodiscard]] auto along_crease(Index edge, Index a) const {
        return [=, this](StencilBuilder& row, double weight) {
            if (kinds_[a] != PointKind::Crease) return false;
            for (const Index e : topology_.point_edges[a]) {
                if (e == edge || !topology_.edge_is_crease[e]) continue;
                row.add(other_end(topology_, e, a), weight);
            }
            return true;
        };
    }

    /// The antipodal term at a smooth point of the boundary: the far ends of the boundary edges around it.
    [[nodiscard]] auto across_spokes(Index edge, Index a) const {
        return [=, this](StencilBuilder& row, double weight) {
            if (kinds_[a] != PointKind::Smooth) return false;
            if (!sums_.empty() && sums_.has(about_point(a))) {
                row.add(other_end(topology_, edge, a), weight);
                sums_.add_terms(about_point(a), edge, 0, weight, row);
                return true;
            }
            std::vector<Index> ring;
            ring_of_spokes(topology_, a, edge, ring);
            if (ring.size() < 3) return false;
            for (std::size_t j = 0; j < ring.size(); ++j) {
                const double c = antipodal_(ring.size(), j);
                if (c != 0) row.add(other_end(topology_, ring[j], a), c * weight);
            }
            return true;
        };
    }

    /// Across the edge from a to d, in the boundary surface: the neighbour of d in the next face.
    [[nodiscard]] auto across_surface_edge(Index face, Index a, Index d) const {
        return [=, this](StencilBuilder& row, double weight) {
            const Index edge = edge_in_face(topology_, face, a, d);
            if (topology_.edge_is_crease[edge]) return false;
            row.add(beside(topology_, other_boundary_face(topology_, edge, face), d, a), weight);
            return true;
        };
    }

    /// Across an edge of a boundary face: the two far points of the next boundary face.
    [[nodiscard]] auto over_surface(Index face, Index edge) const {
        return [=, this](StencilBuilder& row, double weight) {
            if (topology_.edge_is_crease[edge]) return false;
            for (const Index p : far_side(topology_, other_boundary_face(topology_, edge, face), edge)) row.add(p, weight);
            return true;
        };
    }

    // Rules of the interior.

    void interior_edge(Index edge, StencilBuilder& row) const {
        const auto [a, b] = topology_.edges[edge];
        add(row, topology_.edges[edge], 0.5);
        const auto faces = topology_.edge_faces[edge];
        if (!topology_.edge_has_ring[edge]) return;
        const double weight = omega_ / static_cast<double>(faces.size());
        for (const Index face : faces) {
            const Index d = beside(topology_, face, a, b), c = beside(topology_, face, b, a);
            add(row, Pair{c, d}, weight);
            both_ways(row, -weight, d, c, across_edge(face, a, d), across_edge(face, b, c));
        }
    }

    void interior_face(Index face, StencilBuilder& row) const {
        add(row, topology_.faces[face], (1 + 2 * omega_) / 4);
        for (const Index cell : topology_.face_cells[face]) add(row, opposite_points(topology_, cell, face), omega_ / 4);
        for (std::size_t k = 0; k < 4; ++k) {
            const Pair g{topology_.faces[face][k], topology_.faces[face][(k + 1) % 4]};
            const Pair h{topology_.faces[face][(k + 3) % 4], topology_.faces[face][(k + 2) % 4]};
            const Index edge_g = topology_.face_edges[face][k], edge_h = topology_.face_edges[face][(k + 2) % 4];
            extrapolated(row, -omega_ / 4, g, h, in_plane(face, edge_g), in_plane(face, edge_h));
            extrapolated(row, -omega_ / 8, lifted(topology_, face, g), lifted(topology_, face, h), diagonal(face, edge_g),
                         diagonal(face, edge_h));
        }
    }

    void interior_cell(Index cell, StencilBuilder& row) const {
        add(row, topology_.cells[cell], (1 + 6 * omega_) / 8);
        for (std::size_t side = 0; side < 6; ++side) {
            const auto near = side_points(topology_, cell, side), far = side_points(topology_, cell, side ^ 1);
            extrapolated(row, -omega_ / 4, near, far, far_points(cell, side), far_points(cell, side ^ 1));
        }
    }

    // Rules of the boundary: they use points of the boundary alone.

    void crease_edge(Index edge, StencilBuilder& row) const {
        const auto [a, b] = topology_.edges[edge];
        add(row, topology_.edges[edge], 0.5 + omega_);
        both_ways(row, -omega_, a, b, along_crease(edge, a), along_crease(edge, b));
    }

    void surface_edge(Index edge, StencilBuilder& row) const {
        const auto [a, b] = topology_.edges[edge];
        add(row, topology_.edges[edge], 0.5 + omega_ / 2);
        both_ways(row, -omega_ / 2, a, b, across_spokes(edge, a), across_spokes(edge, b));
        const auto [f0, f1] = boundary_faces_of(topology_, edge);
        for (const Index face : {f0, f1}) {
            const Index d = beside(topology_, face, a, b), c = beside(topology_, face, b, a);
            add(row, Pair{c, d}, omega_ / 4);
            both_ways(row, -omega_ / 4, d, c, across_surface_edge(face, a, d), across_surface_edge(face, b, c));
        }
    }

    void surface_face(Index face, StencilBuilder& row) const {
        add(row, topology_.faces[face], (1 + 4 * omega_) / 4);
        for (std::size_t k = 0; k < 4; ++k) {
            const Pair g{topology_.faces[face][k], topology_.faces[face][(k + 1) % 4]};
            const Pair h{topology_.faces[face][(k + 3) % 4], topology_.faces[face][(k + 2) % 4]};
            const Index edge_g = topology_.face_edges[face][k], edge_h = topology_.face_edges[face][(k + 2) % 4];
            extrapolated(row, -omega_ / 2, g, h, over_surface(face, edge_g), over_surface(face, edge_h));
        }
    }

    static RingSums::Center about_edge(Index edge) { return {RingSums::Center::Edge, edge}; }
    static RingSums::Center about_point(Index point) { return {RingSums::Center::Point, point}; }
    /// Whether an edge with a ring has sums over it.
    [[nodiscard]] bool has_sums(Index edge) const {
        return !sums_.empty() && topology_.edge_faces[edge].size() >= RingSums::kLong;
    }

    const Topology& topology_;
    double omega_;
    std::vector<PointKind> kinds_;
    std::vector<std::uint8_t> regular_;
    AntipodalWeights antipodal_;
    RingSums sums_;  // empty: rows have all members of their rings
};

}  // namespace

std::unique_ptr<SchemeRules> make_mcq_rules(const Topology& topology, double tension, std::vector<PointKind> kinds) {
    return std::make_unique<McqRules>(topology, tension, std::move(kinds));
}

}  // namespace subvol::detail
