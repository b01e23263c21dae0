// SPDX-License-Identifier: Apache-2.0
#include "surface_matrix.h"

#include <algorithm>

#include "mesh_walls.h"
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

Surface WallRows::surface(std::span<const Vec3> points) const {
    Surface made{{}, triangles};
    for (const Index row : rows) made.points.push_back(points[row]);
    return made;
}

SurfaceMatrix::SurfaceMatrix(const Topology& control, std::span<const Index> materials, const SchemeOptions& scheme)
    : columns_(control.point_count) {
    RefinementTables tables = refinement_tables(control, {.scheme = scheme, .levels = 1});
    StencilTable table = std::move(tables.levels[0]);
    HexMesh finest;
    finest.points.resize(table.rows());
    finest.cells = std::move(tables.cells);
    finest.creases = std::move(tables.creases);
    finest.sharp_faces = std::move(tables.sharp_faces);
    const Topology topology = build_topology(finest);
    if (!interpolates(scheme.kind)) table = limit_stencils(topology, scheme.kind).after(table);
    std::vector<Index> of_children;
    for (const Index material : materials) of_children.insert(of_children.end(), 8, material);
    std::vector<Index> used;
    rows_of_points_.assign(topology.point_count, kNone);
    walls_.resize(materials.empty() ? 1 : std::size_t{1} + std::ranges::max(materials));
    for (Index m = 0; m < walls_.size(); ++m) {
        SurfaceBuilder wall(topology.point_count);
        for (Index c = 0; c < topology.cells.size(); ++c) {
            if (!materials.empty() && of_children[c] != m) continue;
            for (const Index face : topology.cell_faces[c]) {
                if (wall_of(topology, of_children, face) == m) wall.add(outward_quad(topology, c, face));
            }
        }
        for (const Index p : wall.used()) {
            if (rows_of_points_[p] == kNone) {
                rows_of_points_[p] = static_cast<Index>(used.size());
                used.push_back(p);
            }
            walls_[m].rows.push_back(rows_of_points_[p]);
        }
        walls_[m].triangles = wall.finish([&](Index p) { return finest.points[p]; }).triangles;
    }
    matrix_ = rows_of(table, used);
    for (std::size_t k = 0; k < control.creases.size(); ++k) {
        const auto [first, middle] = finest.creases[2 * k];
        const Index last = finest.creases[2 * k + 1][0];
        crease_rows_.push_back({rows_of_points_[first], rows_of_points_[middle], rows_of_points_[last]});
    }
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
