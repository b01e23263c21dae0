// SPDX-License-Identifier: Apache-2.0
#include "surface_matrix.h"

#include <algorithm>

#include "subvol/detail/parallel_each.h"
#include "subvol/detail/sparse_rows.h"
#include "subvol/detail/surface_builder.h"
#include "subvol/limit.h"
#include "subvol/refine.h"

namespace subvol::detail {

namespace {

/// Some rows of a table.
CsrMatrix rows_of(const StencilTable& table, std::span<const Index> rows) {
    const CsrMatrix all = table.csr();
    CsrMatrix some;
    for (const Index row : rows) {
        for (std::size_t k = all.offsets[row]; k < all.offsets[row + 1]; ++k) {
            some.columns.push_back(all.columns[k]);
            some.weights.push_back(all.weights[k]);
        }
        some.offsets.push_back(some.columns.size());
    }
    return some;
}

}  // namespace

SurfaceMatrix::SurfaceMatrix(const Topology& control, const SchemeOptions& scheme) : columns_(control.point_count) {
    RefinementTables tables = refinement_tables(control, {.scheme = scheme, .levels = 1});
    StencilTable table = std::move(tables.levels[0]);
    HexMesh finest;
    finest.points.resize(table.rows());
    finest.cells = std::move(tables.cells);
    finest.creases = std::move(tables.creases);
    finest.sharp_faces = std::move(tables.sharp_faces);
    const Topology topology = build_topology(finest);
    if (!interpolates(scheme.kind)) table = limit_stencils(topology, scheme.kind).after(table);
    SurfaceBuilder hull(topology.point_count);
    for (Index c = 0; c < topology.cells.size(); ++c) {
        for (const Index face : topology.cell_faces[c]) {
            if (topology.face_on_hull(face)) hull.add(outward_quad(topology, c, face));
        }
    }
    matrix_ = rows_of(table, hull.used());
    rows_of_points_.assign(topology.point_count, kNone);
    for (Index row = 0; row < hull.used().size(); ++row) rows_of_points_[hull.used()[row]] = row;
    for (std::size_t k = 0; k < control.creases.size(); ++k) {
        const auto [first, middle] = finest.creases[2 * k];
        const Index last = finest.creases[2 * k + 1][0];
        crease_rows_.push_back({rows_of_points_[first], rows_of_points_[middle], rows_of_points_[last]});
    }
    triangles_ = hull.finish([&](Index p) { return finest.points[p]; }).triangles;
    transpose_ = transpose_of(matrix_, columns_);
}

std::vector<Vec3> SurfaceMatrix::apply(std::span<const Vec3> control) const {
    return product_with(matrix_, control);
}

std::vector<Vec3> SurfaceMatrix::transposed(std::span<const Vec3> values) const {
    return product_with(transpose_, values);
}

std::vector<double> SurfaceMatrix::squares(std::span<const double> weights) const {
    std::vector<double> sums(columns_, 0);
    parallel_each(columns_, [&](std::size_t c) {
        for (std::size_t k = transpose_.offsets[c]; k < transpose_.offsets[c + 1]; ++k) {
            sums[c] += weights[transpose_.columns[k]] * transpose_.weights[k] * transpose_.weights[k];
        }
    });
    return sums;
}

}  // namespace subvol::detail
