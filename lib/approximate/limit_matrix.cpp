// SPDX-License-Identifier: Apache-2.0
#include "limit_matrix.h"

#include <algorithm>

#include "piece_tree.h"
#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/parallel_sums.h"
#include "transposed_table.h"

namespace subvol::detail {

namespace {

// The number of the corner with these parameters.
std::size_t corner_number(bool u, bool v, bool w) {
    return kCornerOctants[(u ? 1u : 0u) + (v ? 2u : 0u) + (w ? 4u : 0u)];
}

}  // namespace

LimitMatrix::LimitMatrix(const Topology& topology, const RefineOptions& options, std::span<const LimitQuery> places)
    : columns_(topology.point_count) {
    RefinementTables tables = refinement_tables(topology, options);
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
    places_.resize(places.size());
    parallel_each(places.size(), [&](std::size_t k) {
        std::size_t cell = places[k].cell;
        Vec3 at = glm::clamp(places[k].uvw, 0.0, 1.0);
        for (int level = 1; level < options.levels; ++level) {
            at *= 2.0;
            const glm::bvec3 upper = glm::greaterThanEqual(at, Vec3(1.0));
            cell = 8 * cell + corner_number(upper.x, upper.y, upper.z);
            at -= Vec3(upper);
        }
        places_[k] = {cell, at};
    });
}

// Node (i,j,k) of 3×3×3 is a corner of the child whose corner of the cell is nearest.
Index LimitMatrix::node(const Place& place, std::size_t i, std::size_t j, std::size_t k) const {
    return cells_[8 * place.cell + corner_number(i == 2, j == 2, k == 2)][corner_number(i > 0, j > 0, k > 0)];
}

template <class Visit>
void LimitMatrix::each_term(const Place& place, const Visit& visit) const {
    const auto u = QuadraticWeights(place.at.x).values, v = QuadraticWeights(place.at.y).values,
               w = QuadraticWeights(place.at.z).values;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = 0; k < 3; ++k) visit(node(place, i, j, k), u[i] * v[j] * w[k]);
        }
    }
}

std::vector<double> LimitMatrix::finest(std::span<const double> control, std::size_t channels) const {
    std::vector<double> level(control.begin(), control.end());
    for (const StencilTable& table : tables_) {
        std::vector<double> finer(table.rows() * channels);
        table.apply(std::span<const double>(level), channels, std::span<double>(finer));
        level = std::move(finer);
    }
    return level;
}

void LimitMatrix::settle(std::span<const Vec3> control, std::span<const Vec3> positions, double near_world) {
    const std::vector<double> points = finest({&control.front().x, 3 * control.size()}, 3);
    parallel_each(places_.size(), [&](std::size_t k) {
        Place& place = places_[k];
        const Vec3 nearest = glm::round(place.at * 2.0);
        const std::size_t point = node(place, static_cast<std::size_t>(nearest.x), static_cast<std::size_t>(nearest.y),
                                       static_cast<std::size_t>(nearest.z));
        const Vec3 x(points[3 * point], points[3 * point + 1], points[3 * point + 2]);
        if (glm::distance(x, positions[k]) < near_world) place.at = nearest / 2.0;
    });
}

std::vector<double> LimitMatrix::apply(std::span<const double> control) const {
    const std::vector<double> points = finest(control, 1);
    std::vector<double> values(rows());
    parallel_each(rows(), [&](std::size_t k) {
        double sum = 0;
        each_term(places_[k], [&](Index point, double weight) { sum += weight * points[point]; });
        values[k] = sum;
    });
    return values;
}

std::vector<double> LimitMatrix::transposed(std::span<const double> values) const {
    std::vector<double> level = parallel_sums(tables_.back().rows(), rows(), [&](std::size_t k, std::vector<double>& sums) {
        each_term(places_[k], [&](Index point, double weight) { sums[point] += weight * values[k]; });
    });
    for (auto table = tables_.rbegin(); table != tables_.rend(); ++table) level = apply_transpose(*table, level, 1);
    return level;
}

}  // namespace subvol::detail
