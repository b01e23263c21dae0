// SPDX-License-Identifier: Apache-2.0
// Catmull-Clark solids [mj1996]: weighted means of cells, faces and edges in the interior, Catmull-Clark surfaces on the
// boundary. Creases are the cubic B-splines of SplineScheme.
#include "spline_scheme.h"

namespace subvol::detail {

namespace {

class CatmullClarkRules final : public SplineScheme {
public:
    using SplineScheme::SplineScheme;

private:
    /// (C̄ + 3Ā + 3M̄ + V)/8 from the means of the cells' centres, the faces' centres and the edges' middles
    void interior_vertex(Index point, StencilBuilder& row) const override {
        const Topology& t = topology();
        std::size_t cells = 0, faces = 0;
        each_cell_at(t, point, [&](Index, std::size_t) { ++cells; });
        each_face_at(t, point, [&](Index, std::size_t) { ++faces; });
        const auto edges = t.point_edges[point];
        const double of_cell = 1.0 / static_cast<double>(8 * cells), of_face = 3.0 / static_cast<double>(8 * faces);
        const double of_edge = 3.0 / static_cast<double>(8 * edges.size());
        each_cell_at(t, point, [&](Index c, std::size_t) { add_mean(row, t.cells[c], of_cell); });
        each_face_at(t, point, [&](Index f, std::size_t) { add_mean(row, t.faces[f], of_face); });
        for (const Index e : edges) add_mean(row, t.edges[e], of_edge);
        row.add(point, 1.0 / 8);
    }

    /// (C̄ + 2Ā + (n−3)M)/n over n faces. Only means are needed, so the order of the ring does not matter.
    void interior_edge(Index edge, StencilBuilder& row) const override {
        const Topology& t = topology();
        const auto faces = t.edge_faces[edge];
        const auto cells = t.edge_cells[edge];
        const auto n = static_cast<double>(faces.size());
        for (const Index c : cells) add_mean(row, t.cells[c], 1 / (n * static_cast<double>(cells.size())));
        for (const Index f : faces) add_mean(row, t.faces[f], 2 / (n * n));
        add_mean(row, t.edges[edge], (n - 3) / n);
    }

    /// V(1−β−γ) + βN̄₁ + γN̄₂ from the means over the n neighbours along edges and the n across faces; β = 3/(2n), γ = 1/(4n)
    void surface_vertex(Index point, StencilBuilder& row) const override {
        const Topology& t = topology();
        double n = 0;
        for (const Index e : t.point_edges[point]) n += t.edge_on_boundary[e];
        for (const Index e : t.point_edges[point]) {
            if (t.edge_on_boundary[e]) row.add(other_end(t, e, point), 3 / (2 * n * n));
        }
        each_face_at(t, point, [&](Index f, std::size_t k) {
            if (t.face_on_boundary(f)) row.add(t.faces[f][(k + 2) % 4], 1 / (4 * n * n));
        });
        row.add(point, 1 - 7 / (4 * n));
    }
};

}  // namespace

std::unique_ptr<SchemeRules> make_catmull_clark_rules(const Topology& topology, std::vector<PointKind> kinds) {
    return std::make_unique<CatmullClarkRules>(topology, std::move(kinds));
}

}  // namespace subvol::detail
