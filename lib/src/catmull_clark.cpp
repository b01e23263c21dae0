// Catmull-Clark solids [mj1996]: inside the means of cells, faces and edges; on the boundary the surface of Catmull and Clark,
// on creases the cubic B-spline.
#include "boundary_rings.h"
#include "incident.h"
#include "schemes.h"
#include "spline_rows.h"

namespace subvol::detail {

namespace {

class CatmullClarkRules final : public SchemeRules {
public:
    explicit CatmullClarkRules(const Topology& topology)
        : topology_(topology), spline_(topology), kinds_(classify_points(topology)) {}

    [[nodiscard]] bool interpolates() const override { return false; }

    void vertex_point(Index point, StencilBuilder& row) const override {
        if (spline_.vertex(point, row)) return;
        switch (kinds_[point]) {
            case PointKind::Interior:
                return interior_vertex(point, row);
            case PointKind::Smooth:
                return surface_vertex(point, row);
            case PointKind::Crease:
                return crease_vertex(point, row);
            case PointKind::Corner:
                return row.add(point, 1);
        }
    }

    void edge_point(Index edge, StencilBuilder& row) const override {
        if (spline_.edge(edge, row)) return;
        if (!topology_.edge_on_boundary[edge]) {
            interior_edge(edge, row);
        } else if (topology_.edge_is_crease[edge]) {
            add_mean(row, topology_.edges[edge], 1);
        } else {
            surface_edge(edge, row);
        }
    }

    /// Inside (C₀ + 2A + C₁)/4, always as in a grid.
    void face_point(Index face, StencilBuilder& row) const override {
        if (spline_.face(face, row)) return;
        add_mean(row, topology_.faces[face], 1);
    }

    void cell_point(Index cell, StencilBuilder& row) const override { add_mean(row, topology_.cells[cell], 1); }

private:
    template <std::size_t N>
    static void add_mean(StencilBuilder& row, const std::array<Index, N>& points, double weight) {
        for (const Index p : points) row.add(p, weight / static_cast<double>(N));
    }

    /// (C̄ + 3Ā + 3M̄ + V)/8
    void interior_vertex(Index point, StencilBuilder& row) const {
        std::size_t cells = 0, faces = 0;
        each_cell_at(topology_, point, [&](Index, std::size_t) { ++cells; });
        each_face_at(topology_, point, [&](Index, std::size_t) { ++faces; });
        const auto edges = topology_.point_edges[point];
        const double of_cell = 1.0 / static_cast<double>(8 * cells), of_face = 3.0 / static_cast<double>(8 * faces);
        const double of_edge = 3.0 / static_cast<double>(8 * edges.size());
        each_cell_at(topology_, point, [&](Index c, std::size_t) { add_mean(row, topology_.cells[c], of_cell); });
        each_face_at(topology_, point, [&](Index f, std::size_t) { add_mean(row, topology_.faces[f], of_face); });
        for (const Index e : edges) add_mean(row, topology_.edges[e], of_edge);
        row.add(point, 1.0 / 8);
    }

    /// (C̄ + 2Ā + (n−3)M)/n over n faces; only means, so that it needs no ring.
    void interior_edge(Index edge, StencilBuilder& row) const {
        const auto faces = topology_.edge_faces[edge];
        const auto cells = topology_.edge_cells[edge];
        const auto n = static_cast<double>(faces.size());
        for (const Index c : cells) add_mean(row, topology_.cells[c], 1 / (n * static_cast<double>(cells.size())));
        for (const Index f : faces) add_mean(row, topology_.faces[f], 2 / (n * n));
        add_mean(row, topology_.edges[edge], (n - 3) / n);
    }

    /// V(1−β−γ) + βN̄₁ + γN̄₂ over the n neighbours along edges and the n across faces; β = 3/(2n), γ = 1/(4n)
    void surface_vertex(Index point, StencilBuilder& row) const {
        double n = 0;
        for (const Index e : topology_.point_edges[point]) n += topology_.edge_on_boundary[e];
        for (const Index e : topology_.point_edges[point]) {
            if (topology_.edge_on_boundary[e]) row.add(other_end(topology_, e, point), 3 / (2 * n * n));
        }
        each_face_at(topology_, point, [&](Index f, std::size_t k) {
            if (topology_.face_on_boundary(f)) row.add(topology_.faces[f][(k + 2) % 4], 1 / (4 * n * n));
        });
        row.add(point, 1 - 7 / (4 * n));
    }

    /// The mean of the two ends and of the means of the two boundary faces.
    void surface_edge(Index edge, StencilBuilder& row) const {
        const auto [f0, f1] = boundary_faces_of(topology_, edge);
        add_mean(row, topology_.edges[edge], 0.5);
        for (const Index f : {f0, f1}) add_mean(row, topology_.faces[f], 0.25);
    }

    void crease_vertex(Index point, StencilBuilder& row) const {
        const auto [a, b] = crease_neighbours(topology_, point);
        row.add(point, 6.0 / 8);
        row.add(a, 1.0 / 8);
        row.add(b, 1.0 / 8);
    }

    const Topology& topology_;
    SplineRows spline_;
    std::vector<PointKind> kinds_;
};

}  // namespace

std::unique_ptr<SchemeRules> make_catmull_clark_rules(const Topology& topology) {
    return std::make_unique<CatmullClarkRules>(topology);
}

}  // namespace subvol::detail
