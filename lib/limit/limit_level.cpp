// SPDX-License-Identifier: Apache-2.0
// Which level of refinement approximates the limit within a tolerance. The limit is unknown, but where the field is smooth the
// steps from level to level shrink by a factor of 4, so the last step bounds what is left: 1/4 + 1/16 + … = 1/3 of it.
//
//    ●───○───●───○───●     the nodes of level l along an edge of a control cell: even nodes ● are those of level l − 1
//
// The step to level l is the largest distance of an odd node ○ from its prediction by even nodes: from the mean of the two
// beside it, if cells of level l − 1 are trilinear, or from a parabola through three of them (weights 3/8, 3/4, −1/8), if they
// are triquadratic. In a face or cell the predictions are products of those along the axes.
#include "subvol/limit_level.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numeric>

#include "subvol/dense_cells.h"

namespace subvol {

namespace {

struct Step {
    double position = 0, value = 0;
};

/// The range of each attribute over the points that cells use; others may have any value. The mesh is valid.
std::vector<double> ranges_of(const HexMesh& mesh) {
    std::vector<std::uint8_t> used(mesh.points.size(), 0);
    for (const auto& cell : mesh.cells) {
        for (const Index p : cell) used[p] = 1;
    }
    std::vector<double> ranges;
    for (const Attribute& attribute : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        double min = HUGE_VAL, max = -HUGE_VAL;
        for (std::size_t i = 0; i < attribute.values.size(); ++i) {
            if (!used[i / channels]) continue;
            min = std::min(min, attribute.values[i]);
            max = std::max(max, attribute.values[i]);
        }
        constexpr double kRounding = 1e-12;  // relative: a field that varies less is constant
        ranges.push_back(max - min > kRounding * std::max(std::abs(min), std::abs(max)) ? max - min : HUGE_VAL);
    }
    return ranges;
}

/// The nodes and weights that predict a node of a grid.
struct Prediction {
    std::size_t count = 1;
    std::array<std::size_t, 27> nodes;
    std::array<double, 27> weights;

    explicit Prediction(std::size_t node) : nodes{node}, weights{1.0} {}

    /// Replaces each node by the nodes that predict it along an axis.
    template <std::size_t N>
    void spread(std::size_t stride, const std::array<int, N>& steps, const std::array<double, N>& by) {
        for (std::size_t p = 0; p < count; ++p) {
            const auto node = static_cast<std::ptrdiff_t>(nodes[p]), one = static_cast<std::ptrdiff_t>(stride);
            for (std::size_t i = N; i-- > 0;) {
                nodes[i * count + p] = static_cast<std::size_t>(node + steps[i] * one);
                weights[i * count + p] = by[i] * weights[p];
            }
        }
        count *= N;
    }
};

/// An odd node is predicted by the mean of the even nodes beside it.
void spread_linear(Prediction& prediction, std::size_t, std::size_t stride) {
    prediction.spread<2>(stride, {-1, 1}, {0.5, 0.5});
}

/// An odd node is predicted by the parabola through three even nodes, the middle one at twice an odd number.
void spread_quadratic(Prediction& prediction, std::size_t at, std::size_t stride) {
    if (at % 4 == 1) {
        prediction.spread<3>(stride, {-1, 1, 3}, {0.375, 0.75, -0.125});
    } else {
        prediction.spread<3>(stride, {1, -1, -3}, {0.375, 0.75, -0.125});
    }
}

/// The largest distance of a grid's odd nodes from their predictions.
template <class Spread>
Step last_step(const DenseCell& cell, const std::vector<double>& ranges, const Spread& spread) {
    Step most;
    const std::size_t side = cell.side, strides[3] = {1, side, side * side};
    for (std::size_t n = 0; n < cell.points.size(); ++n) {
        const std::size_t at[3] = {n % side, n / side % side, n / side / side};
        Prediction from(n);
        for (std::size_t d = 0; d < 3; ++d) {
            if (at[d] % 2 != 0) spread(from, at[d], strides[d]);
        }
        if (from.count == 1) continue;
        Vec3 place(0.0);
        for (std::size_t p = 0; p < from.count; ++p) place += from.weights[p] * cell.points[from.nodes[p]];
        most.position = std::max(most.position, glm::length(cell.points[n] - place));
        for (std::size_t a = 0; a < cell.values.size(); ++a) {
            const std::size_t channels = cell.values[a].size() / cell.points.size();
            for (std::size_t c = 0; c < channels; ++c) {
                double value = 0;
                for (std::size_t p = 0; p < from.count; ++p) {
                    value += from.weights[p] * cell.values[a][from.nodes[p] * channels + c];
                }
                most.value = std::max(most.value, std::abs(cell.values[a][n * channels + c] - value) / ranges[a]);
            }
        }
    }
    return most;
}

bool fits(std::size_t count, int level, double most) {
    return static_cast<double>(count) * std::pow(8.0, level) <= most;
}

std::vector<Index> all_cells(const HexMesh& mesh) {
    std::vector<Index> cells(mesh.cells.size());
    std::iota(cells.begin(), cells.end(), Index{0});
    return cells;
}

}  // namespace

LimitLevel find_limit_level(const HexMesh& mesh, RefineOptions refinement, const LimitLevelOptions& options) {
    validate(mesh);
    const std::vector<double> ranges = ranges_of(mesh);
    refinement.progress = nullptr;
    std::vector<Index> open = all_cells(mesh);
    LimitLevel result;
    for (int level = 1; level <= options.max_levels && fits(mesh.cells.size(), level, options.max_cells); ++level) {
        refinement.levels = level;
        result = {.level = level - 1};
        std::vector<Index> next;
        std::mutex adding;
        for_each_dense_cell(mesh, refinement, {.cells = open, .on_limit = true}, [&](const DenseCell& cell) {
            const Step step = last_step(cell, ranges, spread_linear);
            const std::scoped_lock lock(adding);
            result.position_world = std::max(result.position_world, step.position);
            result.value_of_range = std::max(result.value_of_range, step.value);
            if (step.position > options.position_world || step.value > options.value_of_range) next.push_back(cell.cell);
        });
        result.converged = next.empty();
        if (result.converged) return result;
        result.level = level;
        std::ranges::sort(next);
        open = std::move(next);
    }
    return result;
}

LimitCells find_limit_cells(const HexMesh& mesh, RefineOptions refinement, const LimitLevelOptions& options) {
    constexpr double kLeft = 0.25;  // the next step is this part of the last one, where the field is smooth
    const std::size_t count = mesh.cells.size();
    LimitCells result{.cell_levels = {}, .converged = count == 0};
    if (count == 0 || !fits(count, 1, options.max_cells)) return result;
    validate(mesh);
    const std::vector<double> ranges = ranges_of(mesh);
    refinement.progress = nullptr;
    const DenseCells dense(mesh, refinement, true);
    result.cell_levels.resize(count);
    std::vector<Step> left(count);
    const auto is_placed = [&](Index c) { return left[c].position <= options.position_world; };
    const auto has_values = [&](Index c) { return left[c].value <= options.value_of_range; };
    std::vector<Index> open = all_cells(mesh);
    for (int level = 1; !open.empty() && level <= options.max_levels && fits(open.size(), level, options.max_cells); ++level) {
        dense.for_each(open, level, [&](const DenseCell& cell) {
            const Step linear = last_step(cell, ranges, spread_linear);
            left[cell.cell].position = linear.position;
            if (level > 1 && has_values(cell.cell)) return;
            const double curved = level > 1 ? last_step(cell, ranges, spread_quadratic).value : HUGE_VAL;
            double& value = left[cell.cell].value;
            value = curved;
            if (value <= options.value_of_range) return;  // the nodes of the level before are enough
            value = kLeft * std::min(linear.value, curved);
            result.cell_levels[cell.cell] = static_cast<std::uint8_t>(level);
        });
        if (!std::ranges::all_of(open, is_placed) && fits(count, level, options.max_cells)) result.level = level;
        std::erase_if(open, [&](Index c) { return is_placed(c) && has_values(c); });
    }
    result.converged = open.empty();
    if (!interpolates(refinement.scheme.kind)) {
        // The limit of a vertex has different bits at different levels: cells of two levels would not fit together.
        int level = std::ranges::max(result.cell_levels);
        for (; !fits(count, level, options.max_cells); --level) result.converged = false;
        std::ranges::fill(result.cell_levels, static_cast<std::uint8_t>(level));
    }
    for (std::size_t c = 0; c < count; ++c) {
        result.cell_levels[c] = std::max(result.cell_levels[c], static_cast<std::uint8_t>(std::max(result.level, 1)));
        result.position_world = std::max(result.position_world, left[c].position);
        result.value_of_range = std::max(result.value_of_range, left[c].value);
    }
    return result;
}

LimitCells limit_for_voxels(const HexMesh& mesh, const RefineOptions& refinement, double voxel_world) {
    return find_limit_cells(mesh, refinement, {.position_world = kLimitTolerance_voxels * voxel_world});
}

}  // namespace subvol
