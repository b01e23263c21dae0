// SPDX-License-Identifier: Apache-2.0
#include "mean_rows.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "subvol/detail/parallel_each.h"
#include "subvol/limit.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kNodes = kMeanNodes;

// Limit points of a control cell: 3 along each axis, u fastest, from the corners of its children.
constexpr std::array<std::array<std::size_t, 3>, 8> kCorner{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

std::array<Index, kNodes> nodes_of(const std::vector<std::array<Index, 8>>& children, std::size_t cell) {
    std::array<Index, kNodes> nodes{};
    for (std::size_t k = 0; k < 8; ++k) {
        for (std::size_t j = 0; j < 8; ++j) {
            const auto at = [&](std::size_t a) { return kCorner[k][a] + kCorner[j][a]; };
            nodes[at(0) + 3 * at(1) + 9 * at(2)] = children[8 * cell + k][j];
        }
    }
    return nodes;
}

// Values and derivatives of the parabolas through 0, 1/2 and 1 at the points of Gauss, with these points' weights.
struct GaussLine {
    std::array<std::array<double, 3>, 3> value, slope;
    std::array<double, 3> weight{5. / 18, 8. / 18, 5. / 18};

    GaussLine() {
        const double h = std::sqrt(.15);
        const std::array<double, 3> at{.5 - h, .5, .5 + h};
        for (std::size_t g = 0; g < 3; ++g) {
            const double u = at[g];
            value[g] = {(1 - u) * (1 - 2 * u), 4 * u * (1 - u), u * (2 * u - 1)};
            slope[g] = {4 * u - 3, 4 - 8 * u, 4 * u - 1};
        }
    }
};

}  // namespace

std::array<double, kMeanNodes> node_integrals(const std::array<Vec3, kMeanNodes>& x) {
    static const GaussLine line;
    std::array<double, kNodes> weights{};
    for (std::size_t gw = 0; gw < 3; ++gw) {
        for (std::size_t gv = 0; gv < 3; ++gv) {
            for (std::size_t gu = 0; gu < 3; ++gu) {
                std::array<double, kNodes> value;
                Vec3 u(0.0), v(0.0), w(0.0);
                for (std::size_t n = 0; n < kNodes; ++n) {
                    const std::size_t i = n % 3, j = n / 3 % 3, k = n / 9;
                    const double a = line.value[gu][i], b = line.value[gv][j], c = line.value[gw][k];
                    value[n] = a * b * c;
                    u += line.slope[gu][i] * b * c * x[n];
                    v += a * line.slope[gv][j] * c * x[n];
                    w += a * b * line.slope[gw][k] * x[n];
                }
                const double weight = line.weight[gu] * line.weight[gv] * line.weight[gw] * glm::dot(u, glm::cross(v, w));
                for (std::size_t n = 0; n < kNodes; ++n) weights[n] += weight * value[n];
            }
        }
    }
    return weights;
}

namespace {

// As if the cell were a box.
std::array<double, kNodes> even_integrals() {
    std::array<double, kNodes> weights{};
    constexpr std::array<double, 3> kSimpson{1. / 6, 4. / 6, 1. / 6};
    for (std::size_t n = 0; n < kNodes; ++n) weights[n] = kSimpson[n % 3] * kSimpson[n / 3 % 3] * kSimpson[n / 9];
    return weights;
}

// One refinement as weights of the control values: the cells, eight for each control cell, and the rows of their points on the
// limit.
struct RefinedRows {
    std::vector<std::array<Index, 8>> cells;
    CsrMatrix rows;

    RefinedRows(const Topology& topology, const SchemeOptions& scheme, Progress* progress) {
        RefinementTables tables = refinement_tables(topology, {.scheme = scheme, .levels = 1, .progress = progress});
        const std::size_t fine_points = tables.points();
        StencilTable table = std::move(tables.levels.front());
        if (!interpolates(scheme.kind)) {
            HexMesh fine;
            fine.points.resize(fine_points);
            fine.cells = tables.cells;
            fine.creases = tables.creases;
            fine.sharp_faces = tables.sharp_faces;
            table = limit_stencils(build_topology(fine), scheme.kind).after(table);
        }
        rows = table.csr();
        cells = std::move(tables.cells);
    }
};

// The weights of a cell's nodes in its integral, which are volumes; also its volume and its centre.
void weigh_cell(const std::array<Vec3, kNodes>& x, std::array<double, kNodes>& weights, double& volume, Vec3& centre) {
    static const std::array<double, kNodes> kEven = even_integrals();
    weights = node_integrals(x);
    volume = 0;
    double size = 0;
    for (const double weight : weights) {
        volume += weight;
        size += std::abs(weight);
    }
    if (!(volume > .05 * size)) {  // an inverted cell: its middle counts most, whatever its volume
        weights = kEven;
        volume = std::max(std::abs(volume), 1e-300);
        for (double& weight : weights) weight *= volume;
    }
    centre = Vec3(0.0);
    for (std::size_t n = 0; n < kNodes; ++n) centre += weights[n] / volume * x[n];
}

// The rows of the wholes: the mean over a whole is a sum over the nodes of its cells, each of which is a row of control values.
class WholeRows {
public:
    WholeRows(const RefinedRows& refined, const Wholes& wholes, const std::vector<std::array<double, kNodes>>& weights,
              const std::vector<double>& volumes, std::size_t control_points)
        : refined_(refined), wholes_(wholes), weights_(weights), volumes_(volumes), all_sums_([control_points] {
              return std::vector<double>(control_points);
          }) {}

    // In parts, so that rows are computed in parallel and stored in order.
    [[nodiscard]] LaneMatrix matrix() {
        constexpr std::size_t kOfPart = 1024;
        std::vector<LaneMatrix> parts((wholes_.size() + kOfPart - 1) / kOfPart);
        tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
            std::vector<Index> touched;
            for (std::size_t w = part * kOfPart; w < std::min(wholes_.size(), (part + 1) * kOfPart); ++w) {
                add_row(w, touched, parts[part]);
            }
        });
        return joined_rows(std::move(parts));
    }

private:
    // sums: one for each control point, all 0 before and after
    void add_row(std::size_t whole, std::vector<Index>& touched, LaneMatrix& out) {
        std::vector<double>& sums = all_sums_.local();
        const CsrMatrix& rows = refined_.rows;
        touched.clear();
        double volume = 0;
        for (const Index c : wholes_.cells_of(whole)) volume += volumes_[c];
        for (const Index c : wholes_.cells_of(whole)) {
            const auto nodes = nodes_of(refined_.cells, c);
            for (std::size_t n = 0; n < kNodes; ++n) {
                const double weight = weights_[c][n] / volume;
                for (std::size_t k = rows.offsets[nodes[n]]; k < rows.offsets[nodes[n] + 1]; ++k) {
                    touched.push_back(rows.columns[k]);
                    sums[rows.columns[k]] += weight * rows.weights[k];
                }
            }
        }
        std::ranges::sort(touched);
        touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
        for (const Index column : touched) {
            if (sums[column] != 0) {
                out.columns.push_back(column);
                out.weights.push_back(static_cast<float>(sums[column]));
            }
            sums[column] = 0;
        }
        out.offsets.push_back(out.columns.size());
    }

    const RefinedRows& refined_;
    const Wholes& wholes_;
    const std::vector<std::array<double, kNodes>>& weights_;
    const std::vector<double>& volumes_;
    tbb::enumerable_thread_specific<std::vector<double>> all_sums_;
};

}  // namespace

Wholes wholes_of(std::size_t count, std::span<const Index> parts) {
    Wholes wholes;
    wholes.cells.resize(count);
    wholes.of_cell.resize(count);
    std::iota(wholes.cells.begin(), wholes.cells.end(), Index{0});
    if (!parts.empty()) std::ranges::stable_sort(wholes.cells, {}, [&](Index c) { return parts[c]; });
    for (std::size_t i = 0; i < count; ++i) {
        const bool same = i > 0 && !parts.empty() && parts[wholes.cells[i]] == parts[wholes.cells[i - 1]];
        if (same) {
            wholes.offsets.back() = i + 1;
        } else {
            wholes.offsets.push_back(i + 1);
        }
        wholes.of_cell[wholes.cells[i]] = wholes.size() - 1;
    }
    return wholes;
}

MeanRows mean_rows(const HexMesh& mesh, const Topology& topology, const Wholes& wholes, const SchemeOptions& scheme,
                   Progress* progress) {
    const RefinedRows refined(topology, scheme, progress);
    const std::vector<Vec3> points = product_with(refined.rows, mesh.points);
    MeanRows means;
    const std::size_t cells = mesh.cells.size();
    means.volumes.resize(cells);
    means.centres.resize(cells);
    std::vector<std::array<double, kNodes>> weights(cells);
    parallel_each(cells, [&](std::size_t c) {
        const auto nodes = nodes_of(refined.cells, c);
        std::array<Vec3, kNodes> x;
        for (std::size_t n = 0; n < kNodes; ++n) x[n] = points[nodes[n]];
        weigh_cell(x, weights[c], means.volumes[c], means.centres[c]);
    });
    means.matrix = WholeRows(refined, wholes, weights, means.volumes, mesh.points.size()).matrix();
    return means;
}

}  // namespace subvol::detail
