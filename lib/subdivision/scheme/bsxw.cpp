// SPDX-License-Identifier: Apache-2.0
// The scheme of Bajaj, Schaefer, Warren and Xu [bsxw2002]: a trilinear split into small hexahedra, then every point becomes the
// mean of the centroids of the small hexahedra around it; of the small quads on the boundary, of the small segments on creases.
// Both steps are done at once: the centroid of a small hexahedron is the trilinear point of its parent a quarter of the way in
// from a corner.
#include "spline_scheme.h"
#include "subvol/cell.h"

namespace subvol::detail {

namespace {

class BsxwRules final : public SplineScheme {
public:
    using SplineScheme::SplineScheme;

private:
    void interior_vertex(Index point, StencilBuilder& row) const override {
        std::size_t cells = 0;
        each_cell_at(topology(), point, [&](Index, std::size_t) { ++cells; });
        const double weight = 1 / static_cast<double>(cells);
        each_cell_at(topology(), point, [&](Index c, std::size_t corner) { add_quarter_point(row, c, corner, weight); });
    }

    void interior_edge(Index edge, StencilBuilder& row) const override {
        const auto cells = topology().edge_cells[edge];
        const double weight = 1 / static_cast<double>(2 * cells.size());
        for (const Index c : cells) {
            for (const Index p : topology().edges[edge]) add_quarter_point(row, c, slot_of(topology().cells[c], p), weight);
        }
    }

    void surface_vertex(Index point, StencilBuilder& row) const override {
        constexpr std::array<double, 4> kBySteps{9.0 / 16, 3.0 / 16, 1.0 / 16, 3.0 / 16};
        std::size_t faces = 0;
        each_face_at(topology(), point, [&](Index f, std::size_t) { faces += topology().face_on_boundary(f); });
        each_face_at(topology(), point, [&](Index f, std::size_t corner) {
            if (!topology().face_on_boundary(f)) return;
            for (std::size_t s = 0; s < 4; ++s) {
                row.add(topology().faces[f][(corner + s) % 4], kBySteps[s] / static_cast<double>(faces));
            }
        });
    }

    /// The trilinear point of a cell a quarter of the way in from one of its corners.
    void add_quarter_point(StencilBuilder& row, Index cell, std::size_t corner, double weight) const {
        constexpr std::array<double, 4> kByAxesApart{27.0 / 64, 9.0 / 64, 3.0 / 64, 1.0 / 64};
        const auto& a = kCornerParameters[corner];
        for (std::size_t k = 0; k < 8; ++k) {
            const auto& b = kCornerParameters[k];
            const auto apart = static_cast<std::size_t>((a[0] != b[0]) + (a[1] != b[1]) + (a[2] != b[2]));
            row.add(topology().cells[cell][k], weight * kByAxesApart[apart]);
        }
    }
};

}  // namespace

std::unique_ptr<SchemeRules> make_bsxw_rules(const Topology& topology, std::vector<PointKind> kinds) {
    return std::make_unique<BsxwRules>(topology, std::move(kinds));
}

}  // namespace subvol::detail
