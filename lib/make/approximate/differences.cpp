// SPDX-License-Identifier: Apache-2.0
#include "differences.h"

#include <cmath>
#include <utility>

#include "sheets.h"

namespace subvol::detail {

namespace {

class Rows {
public:
    void add(Index point, double weight) {
        matrix_.columns.push_back(point);
        matrix_.weights.push_back(weight);
    }
    void end_row() { matrix_.offsets.push_back(matrix_.columns.size()); }

    [[nodiscard]] CsrMatrix take() { return std::move(matrix_); }

private:
    CsrMatrix matrix_;
};

class SecondDifferences {
public:
    SecondDifferences(const HexMesh& mesh, const Topology& topology, double weight, Rows& rows)
        : mesh_(mesh), topology_(topology), factor_(2 * std::sqrt(weight)), rows_(rows) {}

    void add_at(Index point) {
        std::vector<Index> ended;
        for (const Index e : topology_.point_edges[point]) {
            const Index next = edge_beyond(topology_, e, point);
            if (next == kNone || edge_beyond(topology_, next, point) != e) {
                ended.push_back(e);
            } else if (e < next) {
                add_mean({e, next}, point);
            }
        }
        if (topology_.point_on_boundary[point] == 0 && ended.size() > 1) add_mean(ended, point);
    }

private:
    void add_mean(const std::vector<Index>& edges, Index point) {
        double sum = 0;
        std::vector<double> nearness;
        for (const Index e : edges) {
            const double length = glm::distance(mesh_.points[topology_.edges[e][0]], mesh_.points[topology_.edges[e][1]]);
            if (!(length > 0)) return;
            nearness.push_back(1 / length);
            sum += nearness.back();
        }
        for (std::size_t k = 0; k < edges.size(); ++k) {
            const auto& [a, b] = topology_.edges[edges[k]];
            rows_.add(a == point ? b : a, factor_ * nearness[k] / sum);
        }
        rows_.add(point, -factor_);
        rows_.end_row();
    }

    const HexMesh& mesh_;
    const Topology& topology_;
    double factor_;
    Rows& rows_;
};

}  // namespace

CsrMatrix differences(const HexMesh& mesh, const Topology& topology, const DifferenceWeights& weights) {
    Rows rows;
    if (weights.first > 0) {
        for (const auto& [a, b] : topology.edges) {
            rows.add(a, std::sqrt(weights.first));
            rows.add(b, -std::sqrt(weights.first));
            rows.end_row();
        }
    }
    if (weights.second > 0) {
        SecondDifferences second(mesh, topology, weights.second, rows);
        for (Index p = 0; p < topology.point_count; ++p) second.add_at(p);
    }
    return rows.take();
}

}  // namespace subvol::detail
