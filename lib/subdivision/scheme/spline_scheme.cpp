// SPDX-License-Identifier: Apache-2.0
#include "spline_scheme.h"

namespace subvol::detail {

void SplineScheme::vertex_point(Index point, StencilBuilder& row) const {
    if (regular_[point]) return regular_vertex(point, row);
    switch (kinds_[point]) {
        case PointKind::Interior:
            return interior_vertex(point, row);
        case PointKind::Smooth:
            return surface_vertex(point, row);
        case PointKind::Crease: {
            const auto [a, b] = crease_neighbours(topology_, point);
            row.add(point, 6.0 / 8);
            row.add(a, 1.0 / 8);
            row.add(b, 1.0 / 8);
            return;
        }
        case PointKind::Corner:
            return row.add(point, 1);
    }
}

void SplineScheme::edge_point(Index edge, StencilBuilder& row) const {
    const auto& ends = topology_.edges[edge];
    if (regular_[ends[0]] && regular_[ends[1]]) {
        regular_edge(edge, row);
    } else if (!topology_.edge_on_boundary[edge]) {
        interior_edge(edge, row);
    } else if (topology_.edge_is_crease[edge]) {
        add_mean(row, ends, 1);
    } else {  // the mean of the two ends and of the means of the two boundary faces
        const auto [f0, f1] = boundary_faces_of(topology_, edge);
        add_mean(row, ends, 0.5);
        for (const Index f : {f0, f1}) add_mean(row, topology_.faces[f], 0.25);
    }
}

/// Every interior face has two cells, as in a grid: one rule is enough.
void SplineScheme::face_point(Index face, StencilBuilder& row) const {
    if (topology_.face_on_boundary(face)) return add_mean(row, topology_.faces[face], 1);
    std::array<Index, 8> cells;
    std::size_t c = 0;
    for (const Index cell : topology_.face_cells[face]) {
        for (const Index p : topology_.faces[face]) cells[c++] = across_cell(topology_, cell, p);
    }
    row.add_run(topology_.faces[face], 6. / 32);
    row.add_run(cells, 1. / 32);
}

void SplineScheme::regular_vertex(Index point, StencilBuilder& row) const {
    std::array<Index, 6> edges;
    std::array<Index, 12> faces;
    std::array<Index, 8> cells;
    std::size_t e = 0, f = 0, c = 0;
    for (const Index edge : topology_.point_edges[point]) edges[e++] = other_end(topology_, edge, point);
    each_face_at(topology_, point, [&](Index face, std::size_t k) { faces[f++] = topology_.faces[face][(k + 2) % 4]; });
    each_cell_at(topology_, point, [&](Index cell, std::size_t) { cells[c++] = across_cell(topology_, cell, point); });
    row.add_run(std::array{point}, 216. / 512);
    row.add_run(edges, 36. / 512);
    row.add_run(faces, 6. / 512);
    row.add_run(cells, 1. / 512);
}

void SplineScheme::regular_edge(Index edge, StencilBuilder& row) const {
    const auto& ends = topology_.edges[edge];
    std::array<Index, 8> faces, cells;
    std::size_t f = 0, c = 0;
    for (const Index p : ends) {
        for (const Index face : topology_.edge_faces[edge]) faces[f++] = across_face(topology_, face, p);
        for (const Index cell : topology_.edge_cells[edge]) cells[c++] = across_cell(topology_, cell, p);
    }
    row.add_run(ends, 36. / 128);
    row.add_run(faces, 6. / 128);
    row.add_run(cells, 1. / 128);
}

}  // namespace subvol::detail
