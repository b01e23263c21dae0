// SPDX-License-Identifier: Apache-2.0
#include "table_rows.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "subvol/cell.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/parallel_sums.h"
#include "subvol/detail/piece_tree.h"
#include "subvol/detail/refined_memory.h"
#include "subvol/detail/row_access.h"
#include "subvol/detail/sparse_rows.h"
#include "subvol/detail/transposed_table.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

// The number of the corner with these parameters.
std::size_t corner_number(bool u, bool v, bool w) {
    return kCornerOctants[(u ? 1u : 0u) + (v ? 2u : 0u) + (w ? 4u : 0u)];
}

// Sums of terms of one row after the other.
struct RowSums {
    std::vector<double> sums;
    std::vector<std::uint8_t> is_term;
    std::vector<Index> terms;

    void add(Index column, double weight) {
        if (is_term[column] == 0) terms.push_back(column);
        is_term[column] = 1;
        sums[column] += weight;
    }

    // Appends the row and forgets it.
    void finish(CsrMatrix& matrix) {
        std::ranges::sort(terms);
        for (const Index column : terms) {
            if (sums[column] != 0) {
                matrix.columns.push_back(column);
                matrix.weights.push_back(sums[column]);
            }
            sums[column] = 0;
            is_term[column] = 0;
        }
        terms.clear();
        matrix.offsets.push_back(matrix.columns.size());
    }
};

// A matrix of some rows: each_term(row, visit) visits their terms.
template <class EachTerm>
CsrMatrix matrix_of(std::size_t rows, std::size_t columns, const EachTerm& each_term) {
    constexpr std::size_t kRun = 512;
    std::vector<CsrMatrix> runs((rows + kRun - 1) / kRun);
    tbb::enumerable_thread_specific<RowSums> all_sums([&] {
        return RowSums{std::vector<double>(columns), std::vector<std::uint8_t>(columns), {}};
    });
    tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t r) {
        RowSums& sums = all_sums.local();
        for (std::size_t row = r * kRun; row < std::min(rows, (r + 1) * kRun); ++row) {
            each_term(row, [&](Index column, double weight) { sums.add(column, weight); });
            sums.finish(runs[r]);
        }
    });
    return joined_rows(std::move(runs));
}

}  // namespace

TableRows::TableRows(const HexMesh& mesh, const RefineOptions& options, std::span<const std::uint8_t> cells,
                     std::span<const LimitQuery> places, const Settling& settling, const std::string& where) {
    std::vector<std::uint8_t> kept(cells.begin(), cells.end());
    grow(mesh, kept, kHaloOfLimit);
    MeshSubset part = subset(mesh, kept);
    constexpr double kBytesOfFineCell = 300;  // of its stencils, and of what is computed for its points
    check_memory(options.levels, static_cast<double>(part.cells.size()) * std::pow(8.0, options.levels), kBytesOfFineCell,
                 where);
    points_ = std::move(part.points);
    RefinementTables tables = refinement_tables(build_topology(part.mesh), options);
    tables_ = std::move(tables.levels);
    cells_ = std::move(tables.cells);
    const Scheme scheme = options.scheme.kind;
    if (!interpolates(scheme)) {
        HexMesh finest;
        finest.points.resize(tables_.back().rows());
        finest.cells = cells_;
        finest.creases = std::move(tables.creases);
        finest.sharp_faces = std::move(tables.sharp_faces);
        tables_.push_back(limit_stencils(build_topology(finest), scheme));
    }
    for (std::size_t k = 0; k < places.size(); ++k) {
        if (cells[places[k].cell] != 0) places_.push_back({places[k].cell, glm::clamp(places[k].uvw, 0.0, 1.0), k});
    }
    parallel_each(places_.size(), [&](std::size_t k) {
        auto& [cell, at, row] = places_[k];
        cell = static_cast<std::size_t>(std::ranges::lower_bound(part.cells, cell) - part.cells.begin());
        for (int level = 1; level < options.levels; ++level) {
            at *= 2.0;
            const glm::bvec3 upper = glm::greaterThanEqual(at, Vec3(1.0));
            cell = 8 * cell + corner_number(upper.x, upper.y, upper.z);
            at -= Vec3(upper);
        }
    });
    if (!settling.positions.empty()) settle(part.mesh.points, settling);
    if (places_.size() <= kFormedPlaces * part.cells.size()) form();
}

// Node (i,j,k) of 3×3×3 is a corner of the child whose corner of the cell is nearest.
Index TableRows::node(const Place& place, std::size_t i, std::size_t j, std::size_t k) const {
    return cells_[8 * place.cell + corner_number(i == 2, j == 2, k == 2)][corner_number(i > 0, j > 0, k > 0)];
}

template <class Visit>
void TableRows::each_term(const Place& place, const Visit& visit) const {
    const auto u = QuadraticWeights(place.at.x).values, v = QuadraticWeights(place.at.y).values,
               w = QuadraticWeights(place.at.z).values;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = 0; k < 3; ++k) visit(node(place, i, j, k), u[i] * v[j] * w[k]);
        }
    }
}

std::vector<double> TableRows::finest(std::vector<double> level, std::size_t channels) const {
    for (const StencilTable& table : tables_) {
        std::vector<double> finer(table.rows() * channels);
        table.apply(std::span<const double>(level), channels, std::span<double>(finer));
        level = std::move(finer);
    }
    return level;
}

void TableRows::settle(std::span<const Vec3> control, const Settling& settling) {
    const double* const first = &control.front().x;
    const std::vector<double> points = finest({first, first + 3 * control.size()}, 3);
    parallel_each(places_.size(), [&](std::size_t k) {
        Place& place = places_[k];
        const Vec3 nearest = glm::round(place.at * 2.0);
        const std::size_t point = node(place, static_cast<std::size_t>(nearest.x), static_cast<std::size_t>(nearest.y),
                                       static_cast<std::size_t>(nearest.z));
        const Vec3 x(points[3 * point], points[3 * point + 1], points[3 * point + 2]);
        if (glm::distance(x, settling.positions[place.row]) < settling.near_world) place.at = nearest / 2.0;
    });
}

// From the finest level to the control points, row by row.
void TableRows::form() {
    formed_ = matrix_of(places_.size(), tables_.back().rows(), [&](std::size_t k, const auto& add) {
        each_term(places_[k], [&](Index point, double weight) {
            if (weight != 0) add(point, weight);
        });
    });
    for (; !tables_.empty(); tables_.pop_back()) {
        const RowAccess table(tables_.back());
        formed_ = matrix_of(places_.size(), tables_.back().columns(), [&](std::size_t k, const auto& add) {
            for (std::size_t i = formed_.offsets[k]; i < formed_.offsets[k + 1]; ++i) {
                table.terms(formed_.columns[i], [&](Index point, double weight) { add(point, formed_.weights[i] * weight); });
            }
        });
    }
    cells_ = {};
}

void TableRows::apply(std::span<const double> control, std::span<double> values) const {
    if (places_.empty()) return;
    std::vector<double> level(points_.size());
    parallel_each(level.size(), [&](std::size_t p) { level[p] = control[points_[p]]; });
    if (tables_.empty()) {
        parallel_each(places_.size(), [&](std::size_t k) { values[places_[k].row] = row_times(formed_, k, level); });
        return;
    }
    const std::vector<double> points = finest(std::move(level), 1);
    parallel_each(places_.size(), [&](std::size_t k) {
        double sum = 0;
        each_term(places_[k], [&](Index point, double weight) { sum += weight * points[point]; });
        values[places_[k].row] = sum;
    });
}

void TableRows::add_transposed(std::span<const double> values, std::vector<double>& sums) const {
    if (places_.empty()) return;
    const std::size_t columns = tables_.empty() ? points_.size() : tables_.back().rows();
    std::vector<double> level = parallel_sums(columns, places_.size(), [&](std::size_t k, std::vector<double>& run) {
        const double value = values[places_[k].row];
        if (tables_.empty()) {
            for (std::size_t i = formed_.offsets[k]; i < formed_.offsets[k + 1]; ++i) {
                run[formed_.columns[i]] += formed_.weights[i] * value;
            }
            return;
        }
        each_term(places_[k], [&](Index point, double weight) { run[point] += weight * value; });
    });
    for (auto table = tables_.rbegin(); table != tables_.rend(); ++table) level = apply_transpose(*table, level, 1);
    parallel_each(level.size(), [&](std::size_t p) { sums[points_[p]] += level[p]; });
}

}  // namespace subvol::detail
