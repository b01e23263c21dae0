// The scheme of Bajaj, Schaefer, Warren and Xu [bsxw2002]: a trilinear split, then every point becomes the mean of the
// centroids of the small hexes about it; on the boundary of the small quads, on creases of the small segments. Both steps in
// one: a small hex's centroid is the trilinear point at 1/4 of its parent, and those about the same parent are averaged first.
#include "boundary_rings.h"
#include "corner_parameters.h"
#include "incident.h"
#include "schemes.h"
#include "spline_rows.h"

namespace subvol::detail {

namespace {

class BsxwRules final : public SchemeRules {
public:
    explicit BsxwRules(const Topology& topology) : topology_(topology), spline_(topology), kinds_(classify_points(topology)) {}

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
        const auto& ends = topology_.edges[edge];
        if (topology_.edge_is_crease[edge]) {
            for (const Index p : ends) row.add(p, 0.5);
        } else if (topology_.edge_on_boundary[edge]) {
            const auto [f0, f1] = boundary_faces_of(topology_, edge);
            for (const Index f : {f0, f1}) add_face(row, f, ends, 0.5);
        } else {
            const auto cells = topology_.edge_cells[edge];
            for (const Index c : cells) add_cell(row, c, ends, 1 / static_cast<double>(cells.size()));
        }
    }

    void face_point(Index face, StencilBuilder& row) const override {
        if (spline_.face(face, row)) return;
        add_face(row, face, topology_.faces[face], 1);
    }

    void cell_point(Index cell, StencilBuilder& row) const override {
        for (const Index p : topology_.cells[cell]) row.add(p, 1.0 / 8);
    }

private:
    void interior_vertex(Index point, StencilBuilder& row) const {
        std::size_t cells = 0;
        each_cell_at(topology_, point, [&](Index, std::size_t) { ++cells; });
        const double weight = 1 / static_cast<double>(cells);
        each_cell_at(topology_, point, [&](Index c, std::size_t) { add_cell(row, c, std::array{point}, weight); });
    }

    void surface_vertex(Index point, StencilBuilder& row) const {
        std::size_t faces = 0;
        each_face_at(topology_, point, [&](Index f, std::size_t) { faces += topology_.face_on_boundary(f); });
        const double weight = 1 / static_cast<double>(faces);
        each_face_at(topology_, point, [&](Index f, std::size_t) {
            if (topology_.face_on_boundary(f)) add_face(row, f, std::array{point}, weight);
        });
    }

    void crease_vertex(Index point, StencilBuilder& row) const {
        const auto [a, b] = crease_neighbours(topology_, point);
        row.add(point, 6.0 / 8);
        row.add(a, 1.0 / 8);
        row.add(b, 1.0 / 8);
    }

    /// The mean of the trilinear points of a cell that lie a quarter of the way in from each of the corners `from`.
    template <std::size_t N>
    void add_cell(StencilBuilder& row, Index cell, const std::array<Index, N>& from, double weight) const {
        constexpr std::array<double, 4> kByAxesApart{27.0 / 64, 9.0 / 64, 3.0 / 64, 1.0 / 64};
        const auto& points = topology_.cells[cell];
        for (const Index p : from) {
            const auto& a = kCornerParameters[slot_of(points, p)];
            for (std::size_t k = 0; k < 8; ++k) {
                const auto& b = kCornerParameters[k];
                const auto apart = static_cast<std::size_t>((a[0] != b[0]) + (a[1] != b[1]) + (a[2] != b[2]));
                row.add(points[k], weight / static_cast<double>(N) * kByAxesApart[apart]);
            }
        }
    }

    /// The mean of the bilinear points of a face that lie a quarter of the way in from each of the corners `from`.
    template <std::size_t N>
    void add_face(StencilBuilder& row, Index face, const std::array<Index, N>& from, double weight) const {
        constexpr std::array<double, 4> kBySteps{9.0 / 16, 3.0 / 16, 1.0 / 16, 3.0 / 16};
        const auto& points = topology_.faces[face];
        for (const Index p : from) {
            const std::size_t k = slot_of(points, p);
            for (std::size_t s = 0; s < 4; ++s) row.add(points[(k + s) % 4], weight / static_cast<double>(N) * kBySteps[s]);
        }
    }

    const Topology& topology_;
    SplineRows spline_;
    std::vector<PointKind> kinds_;
};

}  // namespace

std::unique_ptr<SchemeRules> make_bsxw_rules(const Topology& topology) {
    return std::make_unique<BsxwRules>(topology);
}

}  // namespace subvol::detail
