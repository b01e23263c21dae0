// SPDX-License-Identifier: Apache-2.0
#include "refined_grids.h"

#include <tbb/parallel_for.h>

#include "subvol/detail/place_function.h"
#include "subvol/error.h"
#include "subvol/limit.h"

namespace subvol::detail {

namespace {

void check_tables(const RefinementTables& tables, const HexMesh& mesh, int levels) {
    const std::size_t children = std::size_t{1} << (3 * levels);
    bool fits = tables.control_points == mesh.points.size() && tables.cells.size() == children * mesh.cells.size();
    // Child k keeps corner k of its parent, and control points keep their numbers because all of them are used.
    for (std::size_t c = 0; fits && c < mesh.cells.size(); ++c) {
        for (std::size_t k = 0; k < 8; ++k) {
            const std::size_t child = children * c + (children - 1) / 7 * k;
            fits = fits && tables.cells[child][k] == mesh.cells[c][k];
        }
    }
    if (!fits) {
        throw Error(ErrorCode::InvalidInput, "the refinement tables belong to another mesh or level", {},
                    "a mesh of the same cells, without unused points");
    }
}

std::vector<double> applied(const RefinementTables& tables, const std::vector<double>& control, int channels) {
    return tables.apply(std::span<const double>(control), static_cast<std::size_t>(channels));
}

}  // namespace

RefinementTables tables_of(const HexMesh& mesh, const RefineOptions& refine, bool on_limit) {
    validate(mesh);
    RefinementTables tables = refinement_tables(build_topology(mesh), refine);
    if (!on_limit || interpolates(refine.scheme.kind)) return tables;
    const HexMesh refined{.points = std::vector<Vec3>(tables.points()),
                          .cells = tables.cells,
                          .attributes = {},
                          .creases = tables.creases,
                          .sharp_faces = tables.sharp_faces};
    tables.levels.push_back(limit_stencils(build_topology(refined), refine.scheme.kind));
    return tables;
}

RefinedGrids::RefinedGrids(const CellRequest& request, DenseBits bits)
    : levels_(request.levels()), tables_(request.refines() ? request.tables : nullptr) {
    if (!request.refines() || request.pieces || request.search) return;
    const HexMesh& mesh = *request.mesh;
    for (const Attribute* field : request.fields) mesh_.attributes.push_back(*field);
    mesh_.points = mesh.points;
    if (tables_) {
        check_tables(*tables_, mesh, levels_);
        refine_whole(*tables_);
    } else {
        mesh_.cells = mesh.cells;
        mesh_.creases = mesh.creases;
        mesh_.sharp_faces = mesh.sharp_faces;
        RefineOptions refine = request.refine;
        refine.levels = levels_;
        refine.progress = nullptr;
        dense_.emplace(mesh_, refine, request.on_limit, bits);
        mesh_ = {};
    }
}

void RefinedGrids::refine_whole(const RefinementTables& tables) {
    std::vector<double> points;
    for (const Vec3& p : mesh_.points) points.insert(points.end(), {p.x, p.y, p.z});
    points = applied(tables, points, 3);
    mesh_.points.resize(points.size() / 3);
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
        mesh_.points[i] = {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
    }
    std::vector<Attribute> fields;
    for (const Attribute& field : mesh_.attributes) fields.push_back(without_values(field));
    mesh_ = with_arguments(std::move(mesh_));
    for (Attribute& field : mesh_.attributes) field.values = applied(tables, field.values, field.channels);
    restore_functions(mesh_, fields);

    const std::size_t cells = std::size_t{1} << levels_, side = cells + 1;
    nodes_.resize(side * side * side);
    for (std::size_t child = 0; child < cells * cells * cells; ++child) {
        std::array<std::size_t, 3> at{};
        for (int level = 0; level < levels_; ++level) {  // the first level is the most significant digit
            const std::size_t octant = kCornerOctants[child >> (3 * (levels_ - 1 - level)) & 7];
            for (std::size_t d = 0; d < 3; ++d) at[d] = 2 * at[d] + (octant >> d & 1);
        }
        for (std::size_t k = 0; k < 8; ++k) {
            const std::size_t octant = kCornerOctants[k];
            const std::size_t u = at[0] + (octant & 1), v = at[1] + (octant >> 1 & 1), w = at[2] + (octant >> 2);
            nodes_[u + side * (v + side * w)] = {child, k};
        }
    }
}

void RefinedGrids::for_each(std::span<const Index> cells, int levels,
                            const std::function<void(const DenseCell&)>& visit) const {
    if (dense_) {
        dense_->for_each(cells, levels, visit);
        return;
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size()), [&](const auto& range) {
        DenseCell dense;
        dense.side = (std::size_t{1} << levels_) + 1;
        std::vector<Vec3> points(nodes_.size());
        std::vector<std::vector<double>> values;
        for (const Attribute& field : mesh_.attributes) {
            values.emplace_back(nodes_.size() * static_cast<std::size_t>(field.channels));
            dense.values.emplace_back(values.back());
        }
        dense.points = points;
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            gather(cells[i], dense, points, values);
            visit(dense);
        }
    });
}

void RefinedGrids::gather(Index cell, DenseCell& dense, std::vector<Vec3>& points,
                          std::vector<std::vector<double>>& values) const {
    dense.cell = cell;
    const std::size_t first = static_cast<std::size_t>(cell) << (3 * levels_);
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        const Index point = tables_->cells[first + nodes_[n].cell][nodes_[n].corner];
        points[n] = mesh_.points[point];
        for (std::size_t a = 0; a < values.size(); ++a) {
            const Attribute& field = mesh_.attributes[a];
            const auto channels = static_cast<std::size_t>(field.channels);
            for (std::size_t c = 0; c < channels; ++c) {
                values[a][n * channels + c] =
                    field.constant ? field.cells[cell * channels + c] : field.values[point * channels + c];
            }
        }
    }
}

}  // namespace subvol::detail
