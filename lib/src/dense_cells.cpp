#include "subvol/dense_cells.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "dense_block.h"
#include "patch.h"
#include "run_nested.h"
#include "subvol/error.h"
#include "subvol/limit.h"

namespace subvol {

namespace {

/// So many cells at once that their descendants are some hundred thousand: fewer pay for their surroundings, more for memory.
std::size_t batch_size(int levels) {
    return std::size_t{1} << std::max(0, 18 - 3 * levels);
}

std::vector<Index> all_cells(const HexMesh& mesh) {
    std::vector<Index> cells(mesh.cells.size());
    std::iota(cells.begin(), cells.end(), Index{0});
    return cells;
}

/// Gathers the grid of one control cell from a refined patch.
class Gather {
public:
    void run(const HexMesh& refined, std::size_t first, const detail::DenseBlock& block, DenseCell& cell) {
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

void for_each_dense_cell(const HexMesh& mesh, const RefineOptions& options,
                         const std::function<void(const DenseCell&)>& visit) {
    for_each_dense_cell(mesh, options, {}, visit);
}

void for_each_dense_cell(const HexMesh& mesh, const RefineOptions& options, const DenseSelection& selection,
                         const std::function<void(const DenseCell&)>& visit) {
    const int levels = options.levels;
    if (levels < 0 || levels > 10) {
        throw Error(ErrorCode::InvalidInput, "the number of levels is " + std::to_string(levels), {}, "0 to 10");
    }
    validate(mesh);
    HexMesh control = without_unused_points(mesh);
    if (options.crease_angle_deg && levels > 0) tag_creases(control, *options.crease_angle_deg);
    const detail::PatchSource source(control);
    const detail::DenseBlock block(levels);
    RefineOptions quiet = options;
    quiet.progress = nullptr;
    const std::vector<Index> wanted = selection.cells ? *selection.cells : all_cells(control);
    for (const Index c : wanted) {
        if (c < control.cells.size()) continue;
        throw Error(ErrorCode::InvalidInput, "there is no cell " + std::to_string(c), {},
                    "the mesh has " + std::to_string(control.cells.size()) + " cells");
    }
    const bool move = selection.on_limit && !interpolates(options.scheme);
    const int last_layers = move ? 1 : 0;  // a vertex's limit asks for the cells around it
    const std::size_t batch = batch_size(levels), batches = (wanted.size() + batch - 1) / batch;
    tbb::enumerable_thread_specific<Gather> gathers;
    const auto refine_batch = [&](std::size_t b) {
        const auto first = wanted.begin() + static_cast<std::ptrdiff_t>(b * batch);
        const std::vector<Index> cells(first, first + static_cast<std::ptrdiff_t>(std::min(batch, wanted.size() - b * batch)));
        detail::Patch patch = source.cut(cells, std::min(levels + last_layers, 2));
        for (int level = 1; level <= levels; ++level) {
            patch = detail::refine_patch(patch, quiet, std::min(levels - level + last_layers, 2));
        }
        if (move) patch.mesh = on_limit(std::move(patch.mesh), options.scheme);
        Gather& gather = gathers.local();
        for (std::size_t i = 0; i < cells.size(); ++i) {
            DenseCell cell{.cell = cells[i], .side = 0, .points = {}, .values = {}};
            gather.run(patch.mesh, i << (3 * levels), block, cell);
            visit(cell);
        }
    };
    constexpr std::size_t kTurn = 64;  // batches between two reports of progress
    for (std::size_t turn = 0; turn < batches; turn += kTurn) {
        report_progress(options.progress, "dense cells", static_cast<double>(turn) / static_cast<double>(batches));
        tbb::parallel_for(turn, std::min(batches, turn + kTurn),
                          [&](std::size_t b) { detail::run_nested([&] { refine_batch(b); }); });
    }
    report_progress(options.progress, "dense cells", 1);
}

}  // namespace subvol
