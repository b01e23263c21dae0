// SPDX-License-Identifier: Apache-2.0
// Gradients and second derivatives at the points of a mixed mesh, whose cells have no parameters to take derivatives by: the
// quadratic
//
//     q(d) = f + g·d + ½ dᵀ H d
//
// through the value f at the point, with the least sum of squares Σ (q(dᵢ) − fᵢ)² / |dᵢ|⁴ over its neighbours, since each
// residual is divided by |dᵢ|². Near neighbours count most, as what a quadratic leaves out grows with |d|³. Distances are in
// units of their mean, so that the nine unknowns are of one size and the rank is decided by numbers without dimension: where
// neighbours lie in a plane, the derivatives across it are not determined, and the orthogonal decomposition gives the smallest
// ones.
#include "subvol/detail/point_quadratics.h"

#include <tbb/parallel_sort.h>

#include <Eigen/Dense>
#include <algorithm>

#include "subvol/detail/mixed_shapes.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kEnoughNeighbors = 14;  // as in the lattice of the box spline: nine unknowns and some to spare

}  // namespace

PointNeighbors::PointNeighbors(const MixedMesh& mesh) {
    const auto add = [&](Index a, Index b) {
        pairs_.push_back({a, b});
        pairs_.push_back({b, a});
    };
    each_kind_of(mesh, [&](CellKind kind, const auto& cells) {
        for (const auto& cell : cells) {
            for (const auto& ends : table_of(kind).edges) add(at(cell, ends[0]), at(cell, ends[1]));
        }
    });
    tbb::parallel_sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    offsets_.assign(mesh.points.size() + 1, 0);
    for (const auto& pair : pairs_) ++offsets_[pair[0] + 1];
    for (std::size_t p = 0; p < mesh.points.size(); ++p) offsets_[p + 1] += offsets_[p];
}

void fit_quadratics(const MixedMesh& mesh, const PointNeighbors& neighbors, Index p, std::vector<PointQuadratic>& found) {
    std::size_t channels = 0;
    for (const Attribute& attribute : mesh.attributes) channels += static_cast<std::size_t>(attribute.channels);
    found.assign(channels, {});
    std::vector<Index> around;
    neighbors.each(p, [&](Index q) { around.push_back(q); });
    if (around.size() < kEnoughNeighbors) {
        const std::size_t own = around.size();
        for (std::size_t i = 0; i < own; ++i) neighbors.each(around[i], [&](Index q) { around.push_back(q); });
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        std::erase(around, p);
    }
    const auto rows = static_cast<Eigen::Index>(around.size());
    double unit = 0;  // the mean distance, in which the quadratic is found
    for (const Index q : around) unit += glm::length(mesh.points[q] - mesh.points[p]);
    unit /= static_cast<double>(around.size());
    if (!(unit > 0)) return;
    Eigen::Matrix<double, Eigen::Dynamic, 9> design(rows, 9);
    Eigen::VectorXd weights(rows);
    for (Eigen::Index r = 0; r < rows; ++r) {
        const Vec3 d = (mesh.points[around[static_cast<std::size_t>(r)]] - mesh.points[p]) / unit;
        weights[r] = 1 / std::max(glm::dot(d, d), 1e-12);
        design.row(r) << d.x, d.y, d.z, d.x * d.x / 2, d.x * d.y, d.x * d.z, d.y * d.y / 2, d.y * d.z, d.z * d.z / 2;
        design.row(r) *= weights[r];
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-6);
    solver.compute(design);
    auto quadratic = found.begin();
    for (const Attribute& attribute : mesh.attributes) {
        const auto wide = static_cast<std::size_t>(attribute.channels);
        for (std::size_t c = 0; c < wide; ++c, ++quadratic) {
            const auto value = [&](Index q) { return attribute.values[q * wide + c]; };
            Eigen::VectorXd right(rows);
            for (Eigen::Index r = 0; r < rows; ++r) {
                right[r] = weights[r] * (value(around[static_cast<std::size_t>(r)]) - value(p));
            }
            const Eigen::VectorXd x = solver.solve(right);
            for (int k = 0; k < 3; ++k) quadratic->gradient[k] = x[k] / unit;
            for (std::size_t k = 0; k < 6; ++k) quadratic->second[k] = x[3 + static_cast<Eigen::Index>(k)] / (unit * unit);
        }
    }
}

}  // namespace subvol::detail
