#include "subvol/limit_level.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "subvol/dense_cells.h"

namespace subvol {

namespace {

struct Step {
    double position = 0, value = 0;
};

std::vector<double> ranges_of(const HexMesh& mesh) {
    std::vector<double> ranges;
    for (const Attribute& attribute : mesh.attributes) {
        const auto [min, max] = std::ranges::minmax(attribute.values);
        constexpr double kRounding = 1e-12;  // relative: a field that varies less is constant
        ranges.push_back(max - min > kRounding * std::max(std::abs(min), std::abs(max)) ? max - min : HUGE_VAL);
    }
    return ranges;
}

/// How far the odd nodes of a grid lie from the means of the even ones about them: what its last level brought.
Step last_step(const DenseCell& cell, const std::vector<double>& ranges) {
    Step most;
    const std::size_t side = cell.side, strides[3] = {1, side, side * side};
    for (std::size_t n = 0; n < cell.points.size(); ++n) {
        const std::size_t at[3] = {n % side, n / side % side, n / side / side};
        std::size_t parents[8] = {n}, count = 1;
        for (std::size_t d = 0; d < 3; ++d) {
            if (at[d] % 2 == 0) continue;
            for (std::size_t p = 0; p < count; ++p) {
                parents[count + p] = parents[p] + strides[d];
                parents[p] -= strides[d];
            }
            count *= 2;
        }
        if (count == 1) continue;
        Vec3 middle(0.0);
        for (std::size_t p = 0; p < count; ++p) middle += cell.points[parents[p]];
        most.position = std::max(most.position, glm::length(cell.points[n] - middle / static_cast<double>(count)));
        for (std::size_t a = 0; a < cell.values.size(); ++a) {
            const std::size_t channels = cell.values[a].size() / cell.points.size();
            for (std::size_t c = 0; c < channels; ++c) {
                double mean = 0;
                for (std::size_t p = 0; p < count; ++p) mean += cell.values[a][parents[p] * channels + c];
                const double off = std::abs(cell.values[a][n * channels + c] - mean / static_cast<double>(count));
                most.value = std::max(most.value, off / ranges[a]);
            }
        }
    }
    return most;
}

}  // namespace

LimitLevel find_limit_level(const HexMesh& mesh, RefineOptions refinement, const LimitLevelOptions& options) {
    const std::vector<double> ranges = ranges_of(mesh);
    refinement.progress = nullptr;
    std::vector<Index> open(mesh.cells.size());
    std::iota(open.begin(), open.end(), Index{0});
    LimitLevel result;
    const auto count = static_cast<double>(mesh.cells.size());
    for (int level = 1; level <= options.max_levels && count * std::pow(8.0, level) <= options.max_cells; ++level) {
        refinement.levels = level;
        result = {.level = level - 1};
        std::vector<Index> next;
        std::mutex adding;
        for_each_dense_cell(mesh, refinement, {.cells = open, .on_limit = true}, [&](const DenseCell& cell) {
            const Step step = last_step(cell, ranges);
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

}  // namespace subvol
