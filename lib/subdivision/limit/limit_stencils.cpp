// SPDX-License-Identifier: Apache-2.0
// Where the vertices of a scheme that does not interpolate ([mj1996], [bsxw2002]) lie on the limit.
//
// Let p be a vertex and the other points of the cells around it. One refinement makes the same number of points at the same
// places around the vertex: its edge neighbours become its edge points, and so on. So p' = S p with a small square matrix S,
// and after n levels Sⁿ p. The rows of S sum to 1, its largest eigenvalue is 1, all others are smaller: Sⁿ p converges to a
// single point, l·p with the left eigenvector l S = l, Σ l = 1. In a grid l is the product of (1,4,1)/6 along the three axes.
//
// If two cells around the vertex share a second face, a point is met at two places and S has no unique columns. After one
// refinement this no longer happens: then the limit is taken there and composed with the rows of the refinement.
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

#include "run_nested.h"
#include "subvol/detail/child_topology.h"
#include "subvol/detail/incident.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/patch.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/detail/regular_grid.h"
#include "subvol/detail/scheme_rows.h"
#include "subvol/detail/topology_parts.h"
#include "subvol/limit.h"

namespace subvol {

namespace {

using detail::SchemeRows;
using detail::StencilBuilder;

/// The matrix S of one vertex after the other.
class LocalMatrix {
public:
    LocalMatrix(const Topology& topology, const SchemeRows& rows) : topology_(topology), rows_(rows), first_(topology) {}

    /// Writes the left eigenvector of eigenvalue 1 as a stencil over the mesh's points.
    ///
    /// returns: false, and writes nothing, if a point is met at several places around the vertex
    bool limit_of(Index vertex, StencilBuilder& row) {
        if (detail::is_grid_point(topology_, vertex)) return spline_limit(vertex, row), true;
        if (!collect(vertex)) return false;
        fill_matrix();
        const auto weights = dominant_left_eigenvector();
        for (std::size_t i = 0; i < points_.size(); ++i) row.add(points_[i], weights[i]);
        return true;
    }

private:
    /// (1,4,1)/6 along each of the three axes; on the side of a box along two, on its edge along one.
    void spline_limit(Index vertex, StencilBuilder& row) const {
        const bool inside = !topology_.point_on_boundary[vertex];
        const auto edges = topology_.point_edges[vertex];
        const auto creases = std::count_if(edges.begin(), edges.end(), [&](Index e) { return topology_.edge_is_crease[e]; });
        if (creases > 2) return row.add(vertex, 1);
        // The tensor product of (1,4,1)/6: inside, weights 64, 16, 4 and 1 of 216 for the vertex, its edges, faces and cells;
        // on a side 16, 4 and 1 of 36; along a crease 4 and 1 of 6. A vertex with more than two creases is a corner, which
        // stays.
        const double unit = inside ? 1. / 216 : creases == 2 ? 1. / 6 : 1. / 36;
        row.add(vertex, unit * (inside ? 64 : creases == 2 ? 4 : 16));
        for (const Index e : edges) {
            if (inside || (creases == 2 ? topology_.edge_is_crease[e] : topology_.edge_on_boundary[e])) {
                row.add(detail::other_end(topology_, e, vertex), unit * (inside ? 16 : creases == 2 ? 1 : 4));
            }
        }
        if (creases == 2) return;
        detail::each_face_at(topology_, vertex, [&](Index face, std::size_t k) {
            if (inside || topology_.face_on_boundary(face))
                row.add(topology_.faces[face][(k + 2) % 4], unit * (inside ? 4 : 1));
        });
        if (!inside) return;
        detail::each_cell_at(topology_, vertex,
                             [&](Index cell, std::size_t) { row.add(detail::across_cell(topology_, cell, vertex), unit); });
    }

    struct Entry {
        std::uint32_t row, column;
        double weight;
    };

    /// Finds the points and, for points_[i], the child point child_points_[i] at its place. False if a point occurs twice.
    bool collect(Index vertex) {
        points_.assign(1, vertex);
        child_points_.assign(1, vertex);
        const auto add = [&](Index point, std::size_t child) {
            points_.push_back(point);
            child_points_.push_back(child);
        };
        for (const Index e : topology_.point_edges[vertex]) add(detail::other_end(topology_, e, vertex), first_.edges + e);
        detail::each_face_at(topology_, vertex,
                             [&](Index face, std::size_t k) { add(topology_.faces[face][(k + 2) % 4], first_.faces + face); });
        detail::each_cell_at(topology_, vertex, [&](Index cell, std::size_t) {
            add(detail::across_cell(topology_, cell, vertex), first_.cells + topology_.cell_ordinal[cell]);
        });
        // Points are sorted by number: one that occurs twice stands next to itself, and columns are found by bisection.
        order_.resize(points_.size());
        for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
        std::sort(order_.begin(), order_.end(), [&](auto a, auto b) { return points_[a] < points_[b]; });
        return std::adjacent_find(order_.begin(), order_.end(), [&](auto a, auto b) { return points_[a] == points_[b]; }) ==
               order_.end();
    }

    void fill_matrix() {
        // Row i has the weights of the child point that takes the place of points_[i]. The matrix is sparse, so it is a list of
        // entries.
        matrix_.clear();
        for (std::uint32_t i = 0; i < points_.size(); ++i) {
            row_.clear();
            rows_.write_row(child_points_[i], row_);
            const auto [terms, runs] = row_.finish();
            std::size_t next = 0;
            for (const auto& run : runs) {
                for (std::uint32_t k = 0; k < run.count; ++k) matrix_.push_back({i, column_of(terms[next++]), run.weight});
            }
        }
    }

    /// The rules of these schemes use no point beyond the cells around the vertex.
    [[nodiscard]] std::uint32_t column_of(Index point) const {
        return *std::lower_bound(order_.begin(), order_.end(), point, [&](auto i, Index p) { return points_[i] < p; });
    }

    /// By power iteration: the next eigenvalue is at most about .7, so 1e-17 takes about a hundred steps.
    [[nodiscard]] std::vector<double> dominant_left_eigenvector() const {
        std::vector<double> weights(points_.size(), 0.0), next;
        weights[0] = 1;
        for (int step = 0; step < 400; ++step) {
            next.assign(weights.size(), 0.0);
            for (const auto& [row, column, weight] : matrix_) next[column] += weights[row] * weight;
            double change = 0;
            for (std::size_t i = 0; i < weights.size(); ++i) change = std::max(change, std::abs(next[i] - weights[i]));
            weights.swap(next);
            if (change < 1e-17) break;
        }
        return weights;
    }

    const Topology& topology_;
    const SchemeRows& rows_;
    detail::ChildNumbering first_;
    StencilBuilder row_;
    std::vector<Index> points_;
    std::vector<std::size_t> child_points_;
    std::vector<std::uint32_t> order_;  // of points_, by id
    std::vector<Entry> matrix_;
};

/// The limits of vertices around which a point occurs twice: by way of the next level, where none does.
class RefinedLimits {
public:
    RefinedLimits(const Topology& topology, Scheme scheme) : topology_(topology), scheme_(scheme) {}

    void limit_of(Index vertex, const SchemeRows& rows, StencilBuilder& row) const {
        // Without run_nested, a thread waiting here could take up another block and come here again.
        std::call_once(built_, [&] {
            detail::run_nested([&] {
                child_ = detail::child_topology(topology_);
                child_rows_ = std::make_unique<SchemeRows>(child_, SchemeOptions{scheme_});
            });
        });
        // limit(v) = Σ l(m) child(m) and child(m) = Σ w(m,p) p, so the weight of p is Σ l(m) w(m,p).
        StencilBuilder over_child, step;
        LocalMatrix(child_, *child_rows_).limit_of(vertex, over_child);
        for_each_term(over_child.finish(), [&](Index middle, double weight) {
            step.clear();
            rows.write_row(middle, step);
            for_each_term(step.finish(), [&](Index point, double w) { row.add(point, weight * w); });
        });
    }

private:
    template <class Visit>
    static void for_each_term(const detail::StencilRuns& row, const Visit& visit) {
        std::size_t next = 0;
        for (const auto& run : row.runs) {
            for (std::uint32_t k = 0; k < run.count; ++k) visit(row.points[next++], run.weight);
        }
    }

    const Topology& topology_;
    Scheme scheme_;
    mutable std::once_flag built_;
    mutable Topology child_;
    mutable std::unique_ptr<SchemeRows> child_rows_;
};

HexMesh moved_to_limit(HexMesh mesh, Scheme scheme, detail::InteriorCreases interior) {
    if (interpolates(scheme)) return mesh;
    validate(mesh);
    const StencilTable table = limit_stencils(detail::build_topology(mesh, interior), scheme);
    std::vector<Vec3> points(mesh.points.size());
    table.apply(std::span<const double>(&mesh.points[0].x, 3 * points.size()), 3,
                std::span<double>(&points[0].x, 3 * points.size()));
    mesh.points = std::move(points);
    const auto move = [&](std::vector<double>& values, std::size_t channels) {
        std::vector<double> moved(values.size());
        table.apply(std::span<const double>(values), channels, std::span<double>(moved));
        values = std::move(moved);
    };
    for (auto& attribute : mesh.attributes) {
        if (detail::is_constant_in_cells(mesh, attribute)) continue;
        if (attribute.function == nullptr) {
            move(attribute.values, static_cast<std::size_t>(attribute.channels));
        } else {
            move(attribute.arguments, attribute.function->arguments);
            detail::evaluate_at_points(attribute);
        }
    }
    return mesh;
}

}  // namespace

StencilTable limit_stencils(const Topology& topology, Scheme scheme) {
    if (interpolates(scheme)) return {topology.point_count, topology.point_count, {}};
    const SchemeRows rows(topology, {scheme});
    const RefinedLimits refined(topology, scheme);
    std::vector<StencilTable::Block> blocks((topology.point_count + detail::kBlockRows - 1) / detail::kBlockRows);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        LocalMatrix local(topology, rows);
        StencilBuilder row;
        detail::StencilBlockWriter block;
        const std::size_t begin = b * detail::kBlockRows, end = std::min(topology.point_count, begin + detail::kBlockRows);
        block.start(begin);
        for (std::size_t p = begin; p < end; ++p) {
            row.clear();
            const auto vertex = static_cast<Index>(p);
            // A point that no cell uses stays where it is.
            if (topology.point_edges[p].empty()) {
                row.add(vertex, 1);
            } else if (!local.limit_of(vertex, row)) {
                refined.limit_of(vertex, rows, row);
            }
            block.push(row.finish());
        }
        blocks[b] = block.block();
    });
    return {topology.point_count, 0, std::move(blocks)};
}

HexMesh on_limit(HexMesh mesh, Scheme scheme) {
    return moved_to_limit(std::move(mesh), scheme, detail::InteriorCreases::Refuse);
}

HexMesh detail::on_limit_of_part(HexMesh part, Scheme scheme) {
    return moved_to_limit(std::move(part), scheme, InteriorCreases::Ignore);
}

HexMesh detail::limit_of_cells(const HexMesh& mesh, std::span<const Index> cells, const RefineOptions& options) {
    if (interpolates(options.scheme.kind)) return refine_cells(mesh, cells, options);
    if (cells.empty()) return {};
    const HexMesh control = with_arguments(control_mesh(mesh, options.scheme, options.levels));
    // The limit of a vertex depends on the cells around it, so a layer of these is refined, too.
    Patch patch = refine_patch(PatchSource(control), cells, options.scheme, options.levels, 1);
    HexMesh fine = on_limit_of_part(std::move(patch.mesh), options.scheme.kind);
    restore_functions(fine, mesh.attributes);
    fine.cells.resize(patch.wanted);
    fine.creases.clear();
    fine.sharp_faces.clear();
    return without_unused_points(std::move(fine));
}

}  // namespace subvol
