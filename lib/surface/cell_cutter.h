// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "grid_numbers.h"
#include "subvol/dense_cells.h"

namespace subvol::detail {

/// Where a surface crosses an edge of the tetrahedra, or a vertex of the grid that is part of a surface.
///
/// a, b:   the ends of the edge, a < b; a vertex: twice the same
/// cell:   one of the control cells that have it; at: of the ends in that cell, in steps of the grid
/// off:    at the ends, the value less the isovalue
/// side:   a face of the hull that it lies on (kCellFaces); 6: none
struct SurfacePoint {
    VertexNumber a, b;
    Index cell;
    std::array<std::array<std::uint16_t, 3>, 2> at;
    std::array<double, 2> off;
    std::uint8_t side = 6;
};

/// The triangles in one control cell. triangles: by the numbers of the points; hull: whether a triangle is part of the hull
struct CellTriangles {
    std::vector<SurfacePoint> points;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint8_t> hull;
};

/// What is cut out of cells. iso: nothing: the hull alone; hull: of an isosurface the part of the hull where values are at
/// least the isovalue
struct Cut {
    std::optional<double> iso{};
    bool hull = false;
};

/// Cuts the tetrahedra (`split_cell`) of all children of a control cell.
///
/// grid: of `numbers`' level; values: one number for each of its vertices
[[nodiscard]] CellTriangles cut_cell(const DenseCell& grid, std::span<const double> values, const Cut& cut,
                                     const Topology& topology, const GridNumbers& numbers);

}  // namespace subvol::detail
