// SPDX-License-Identifier: Apache-2.0
// Grids of refined control cells, by one of two ways:
//
//     DenseBits::OfRefine     patches of the control mesh, refined as `refine` does it: the same bits, and therefore the same
//                             bits where two cells meet, whichever batch each of them is in
//     DenseBits::ToRounding   tables shared by cells of one class (CellRefiner): several times faster, sums in another order
#include "subvol/dense_cells.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>

#include "constant_fields.h"
#include "dense_block.h"
#include "run_nested.h"
#include "subvol/detail/all_cells.h"
#include "subvol/detail/cell_refiner.h"
#include "subvol/detail/patch.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/detail/space_order.h"
#include "subvol/error.h"
#include "subvol/limit.h"

namespace subvol {

namespace {

/// How many cells are refined at once, so that their descendants are some hundred thousand: fewer would spend most of the work
/// on their surroundings, more would take too much memory.
std::size_t batch_size(int levels) {
    return std::size_t{1} << std::max(0, 18 - 3 * levels);
}

/// Gathers the grid of one control cell from a refined patch.
class Gather {
public:
    void run(const HexMesh& refined, std::size_t first, const detail::DenseBlock& block, DenseCell& cell) {
        // The descendants of a cell follow each other in the patch, so their order tells which vertex is which node of the
        // grid.
        block.nodes(refined, first, nodes_);
        points_.resize(nodes_.size());
        values_.resize(refined.attributes.size());
        std::transform(nodes_.begin(), nodes_.end(), points_.begin(), [&](Index p) { return refined.points[p]; });
        cell.side = block.side();
        cell.points = points_;
        cell.values.clear();
        for (std::size_t a = 0; a < values_.size(); ++a) {
            const auto channels = static_cast<std::size_t>(refined.attributes[a].channels);
            values_[a].resize(nodes_.size() * channels);
            for (std::size_t n = 0; n < nodes_.size(); ++n) {
                std::copy_n(refined.attributes[a].values.begin() + static_cast<std::ptrdiff_t>(nodes_[n] * channels), channels,
                            values_[a].begin() + static_cast<std::ptrdiff_t>(n * channels));
            }
            cell.values.emplace_back(values_[a]);
        }
    }

private:
    std::vector<Index> nodes_;
    std::vector<Vec3> points_;
    std::vector<std::vector<double>> values_;
};

}  // namespace

struct DenseCells::State {
    State(const HexMesh& mesh, const RefineOptions& refinement, bool on_limit, DenseBits bits)
        : control(detail::control_mesh(mesh, refinement.scheme, refinement.levels)),
          options(refinement),
          move(on_limit && !interpolates(refinement.scheme.kind)) {
        if (bits == DenseBits::OfRefine) {
            if (detail::has_functions(control)) {
                arguments = std::make_unique<const HexMesh>(detail::with_arguments(HexMesh(control)));
            }
            source.emplace(arguments ? *arguments : control);
        } else {
            refiner.emplace(control, refinement.scheme, on_limit);
        }
    }

    void refine_batch(std::span<const Index> cells, const detail::DenseBlock& block, int levels,
                      const std::function<void(const DenseCell&)>& visit) {
        const int last_layers = move ? 1 : 0;  // the limit of a vertex depends on the cells around it, so they must be there
        detail::Patch patch = detail::refine_patch(*source, cells, options.scheme, levels, last_layers);
        if (move) patch.mesh = on_limit(std::move(patch.mesh), options.scheme.kind);
        detail::restore_functions(patch.mesh, control.attributes);
        Gather& gather = gathers.local();
        for (std::size_t i = 0; i < cells.size(); ++i) {
            DenseCell cell{.cell = cells[i], .side = 0, .points = {}, .values = {}};
            gather.run(patch.mesh, i << (3 * levels), block, cell);
            constants.with_own_values(cell, visit);
        }
    }

    HexMesh control;
    detail::ConstantFields constants{control};
    std::unique_ptr<const HexMesh> arguments;    // the same with arguments of functions, if it has some; of DenseBits::OfRefine
    std::optional<detail::PatchSource> source;   // of these bits
    std::optional<detail::CellRefiner> refiner;  // of DenseBits::ToRounding
    RefineOptions options;
    bool move;
    tbb::enumerable_thread_specific<Gather> gathers;
};

DenseCells::DenseCells(const HexMesh& mesh, const RefineOptions& options, bool on_limit, DenseBits bits)
    : state_(std::make_unique<State>(mesh, options, on_limit, bits)) {
}
DenseCells::~DenseCells() = default;
DenseCells::DenseCells(DenseCells&&) noexcept = default;
DenseCells& DenseCells::operator=(DenseCells&&) noexcept = default;

void DenseCells::for_each(std::span<const Index> cells, const std::function<void(const DenseCell&)>& visit) const {
    for_each(cells, state_->options.levels, visit);
}

void DenseCells::for_each(std::span<const Index> cells, int levels, const std::function<void(const DenseCell&)>& visit) const {
    detail::check_levels(levels);
    const std::size_t count = state_->control.cells.size();
    for (const Index c : cells) {
        if (c < count) continue;
        throw Error(ErrorCode::InvalidInput, "there is no cell " + std::to_string(c), {},
                    "the mesh has " + std::to_string(count) + " cells");
    }
    if (state_->refiner) return state_->refiner->for_each(cells, levels, state_->options.progress, visit);
    const detail::DenseBlock block(levels);
    // The fewest batches of at most this size, then all of about one size.
    const std::size_t most = batch_size(levels), at_least = std::max<std::size_t>(1, (cells.size() + most - 1) / most);
    const std::size_t batch = (cells.size() + at_least - 1) / at_least;  // of equal size, as they run side by side
    const std::size_t batches = batch == 0 ? 0 : (cells.size() + batch - 1) / batch;
    // Neighbours together, as the cells around each batch are refined too.
    std::vector<Index> ordered;
    if (batches > 1) cells = ordered = detail::in_space_order(state_->control, cells);
    constexpr std::size_t kTurn = 64;  // batches between two reports of progress
    for (std::size_t turn = 0; turn < batches; turn += kTurn) {
        report_progress(state_->options.progress, "dense cells", turn, batches);
        tbb::parallel_for(turn, std::min(batches, turn + kTurn), [&](std::size_t b) {
            detail::run_nested([&] {
                state_->refine_batch(cells.subspan(b * batch, std::min(batch, cells.size() - b * batch)), block, levels, visit);
            });
        });
    }
    report_progress(state_->options.progress, "dense cells", 1);
}

void for_each_dense_cell(const HexMesh& mesh, const RefineOptions& options,
                         const std::function<void(const DenseCell&)>& visit) {
    for_each_dense_cell(mesh, options, {}, visit);
}

void for_each_dense_cell(const HexMesh& mesh, const RefineOptions& options, const DenseSelection& selection,
                         const std::function<void(const DenseCell&)>& visit) {
    const DenseCells dense(mesh, options, selection.on_limit);
    dense.for_each(selection.cells ? *selection.cells : detail::all_cells(mesh), visit);
}

}  // namespace subvol
