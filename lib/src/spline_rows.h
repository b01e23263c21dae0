#pragma once

#include "incident.h"
#include "opposite.h"
#include "stencil_row.h"

namespace subvol::detail {

/// The rows of tricubic B-splines, (1,6,1)/8 and (1,1)/2 along each axis: what Catmull-Clark and BSXW are where the mesh is a
/// grid.
class SplineRows {
public:
    explicit SplineRows(const Topology& topology) : topology_(topology), regular_(regular_points(topology)) {}

    /// These write nothing and return false where the mesh is no grid.
    bool vertex(Index point, StencilBuilder& row) const {
        if (!regular_[point]) return false;
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
        return true;
    }

    bool edge(Index edge, StencilBuilder& row) const {
        const auto& ends = topology_.edges[edge];
        if (!regular_[ends[0]] || !regular_[ends[1]]) return false;
        std::array<Index, 8> faces, cells;
        std::size_t f = 0, c = 0;
        for (const Index p : ends) {
            for (const Index face : topology_.edge_faces[edge]) faces[f++] = across_face(topology_, face, p);
            for (const Index cell : topology_.edge_cells[edge]) cells[c++] = across_cell(topology_, cell, p);
        }
        row.add_run(ends, 36. / 128);
        row.add_run(faces, 6. / 128);
        row.add_run(cells, 1. / 128);
        return true;
    }

    bool face(Index face, StencilBuilder& row) const {
        if (topology_.face_on_boundary(face)) return false;
        std::array<Index, 8> cells;
        std::size_t c = 0;
        for (const Index cell : topology_.face_cells[face]) {
            for (const Index p : topology_.faces[face]) cells[c++] = across_cell(topology_, cell, p);
        }
        row.add_run(topology_.faces[face], 6. / 32);
        row.add_run(cells, 1. / 32);
        return true;
    }

private:
    const Topology& topology_;
    std::vector<std::uint8_t> regular_;
};

}  // namespace subvol::detail
