// SPDX-License-Identifier: Apache-2.0
// The lowest level whose trilinear cells are near enough to the limit. Level l is compared
// with level l + 1: if the new vertices lie within tolerance of the trilinear cells, level l is enough (node_steps.h says why
// one step decides). Only cells that fail are looked at again on the next level, so the cost is that of the cells that need it.
#include "subvol/limit_level.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "subvol/dense_cells.h"
#include "subvol/detail/all_cells.h"
#include "subvol/detail/node_steps.h"

namespace subvol {

using namespace detail;

namespace {

/// Whether 8^level times the number of cells, which may exceed 64 bits, is small enough.
bool fits(std::size_t count, int level, double most) {
    return static_cast<double>(count) * std::pow(8.0, level) <= most;
}

}  // namespace

LimitLevel find_limit_level(const HexMesh& mesh, RefineOptions refinement, const LimitLevelOptions& options) {
    validate(mesh);
    const std::vector<double> scales = value_scales(mesh);
    refinement.progress = nullptr;
    std::vector<Index> open = all_cells(mesh);
    LimitLevel result;
    // Level `level` is computed to judge the one before it: its new vertices are compared with the means of their neighbours.
    for (int level = 1; level <= options.max_levels && fits(mesh.cells.size(), level, options.max_cells); ++level) {
        refinement.levels = level;
        result = {.level = level - 1};
        std::vector<Index> next;
        std::mutex adding;
        tbb::enumerable_thread_specific<NodeBlock> blocks;
        for_each_dense_cell(mesh, refinement, {.cells = open, .on_limit = true}, [&](const DenseCell& cell) {
            NodeBlock& nodes = blocks.local();
            nodes.gather(cell, {}, 1, cell.side);
            const Step step = nodes.largest_step(Prediction::Trilinear, scales);
            const std::scoped_lock lock(adding);
            result.position_world = std::max(result.position_world, step.position);
            result.value_of_range = std::max(result.value_of_range, step.value);
            if (step.position > options.position_world || step.value > options.value_of_range) next.push_back(cell.cell);
        });
        result.converged = next.empty();
        if (result.converged) return result;
        result.level = level;
        // The threads found the cells in any order; sorted, the next round does not depend on it.
        std::ranges::sort(next);
        open = std::move(next);
    }
    return result;
}

}  // namespace subvol
