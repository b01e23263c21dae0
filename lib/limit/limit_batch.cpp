// SPDX-License-Identifier: Apache-2.0
#include "limit_batch.h"

#include <algorithm>
#include <cmath>

#include "subvol/cell.h"
#include "topology_parts.h"

namespace subvol::detail {

/// The cells of the queries, ascending. InPatch::cell becomes an index into that list.
std::vector<Index> BatchEvaluator::number_cells(std::vector<InPatch>& open) {
    std::ranges::stable_sort(open, {}, &InPatch::cell);
    std::vector<Index> cells;
    for (InPatch& at : open) {
        if (cells.empty() || cells.back() != at.cell) cells.push_back(at.cell);
        at.cell = static_cast<Index>(cells.size() - 1);
    }
    return cells;
}

BatchEvaluator::BatchEvaluator(const LimitOptions& options, std::span<const double> scales, const Channels& channels,
                               LimitSamples& samples)
    : options_(options),
      channels_(channels),
      settling_(options, scales, channels.stride(), samples),
      jets_(options.scheme.kind, channels.stride()),
      jet_(4 * channels.stride()) {
}

void BatchEvaluator::run(const PatchSource& source, std::span<const LimitQuery> queries, std::span<const std::size_t> numbers) {
    lasts_.resize(numbers.size() * jet_.size());
    std::vector<InPatch> open;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto& [cell, uvw] = queries[numbers[i]];
        open.push_back({cell, {.query = numbers[i], .uvw = uvw, .last = &lasts_[i * jet_.size()]}});
    }
    Patch patch = source.cut(number_cells(open), 2);
    for (int level = 0;; ++level) {
        evaluate_level(patch.mesh, level, open);
        if (open.empty()) return;
        patch = refine_patch(sub_patch(patch, number_cells(open), 2), options_.scheme, 2);
        for (InPatch& at : open) {
            at.place.step_down();
            at.cell = 8 * at.cell + static_cast<Index>(kCornerOctants[at.place.octant]);
        }
    }
}

/// Writes the queries that have converged at this level and removes them from `open`.
void BatchEvaluator::evaluate_level(const HexMesh& mesh, int level, std::vector<InPatch>& open) {
    settling_.report().deepest_level = std::max(settling_.report().deepest_level, level);
    const Topology topology = build_topology(mesh, InteriorCreases::Ignore);
    const std::size_t stride = channels_.stride();
    rows_.resize(mesh.points.size() * stride);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) Channels::read(mesh, static_cast<Index>(p), &rows_[p * stride]);
    Index loaded = kNone;
    bool regular = false;
    GridPoints grid;
    std::erase_if(open, [&](InPatch& at) {
        if (at.cell != loaded) {
            loaded = at.cell;
            regular = options_.scheme.kind != Scheme::Linear && regular_grid(topology, at.cell, grid);
            if (regular) {
                jets_.load_grid(rows_.data(), grid);
            } else {
                std::array<Index, 8> corners;
                for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.cells[at.cell][kCornerOctants[k]];
                jets_.load_corners(rows_.data(), corners);
            }
        }
        jets_.evaluate(at.place.uvw, std::ldexp(1.0, level), jet_.data());
        const bool exact = options_.scheme.kind == Scheme::Linear || (regular && !interpolates(options_.scheme.kind));
        return settling_.settle(at.place, jet_.data(), level, regular, exact);
    });
}

}  // namespace subvol::detail
