// SPDX-License-Identifier: Apache-2.0
#include "refined_store.h"

#include <tbb/parallel_for.h>

#include <bit>
#include <mutex>

#include "space_order.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kBatchCells = 8192, kBatchPlaces = 1U << 19;
constexpr std::size_t kMostBytesOfStore = std::size_t{256} << 20;  // of what is kept
constexpr int kMany = 5;                                           // of the octants of a cell: then all are refined

/// The octants of a cell that have places, bit by bit.
std::uint8_t octants_of(const DescentTask& task, const CellPlaces& in) {
    unsigned octants = 0;
    for (std::size_t n = in.first; n < in.last; ++n) {
        Vec3 uvw = task.queries[task.order[n]].uvw;
        octants |= 1U << step_into_octant(uvw);
    }
    return static_cast<std::uint8_t>(std::popcount(octants) >= kMany ? 0xFFU : octants);
}

}  // namespace

RefinedStore::RefinedStore(const DescentMesh& mesh) : mesh_(mesh), source_(mesh.control), kept_(mesh.control.cells.size()) {
}

std::vector<RefinedStore::Batch> RefinedStore::batches(std::span<const CellPlaces> cells) const {
    std::vector<Vec3> centers;
    for (const CellPlaces& in : cells) {
        const auto& corners = mesh_.control.cells[in.cell];
        centers.push_back(0.5 * (mesh_.control.points[corners[0]] + mesh_.control.points[corners[6]]));
    }
    std::vector<Batch> batches;
    std::size_t places = 0;
    for (const Index i : space_order(centers)) {
        const CellPlaces& in = cells[i];
        // A cell with very many places is shared by several batches.
        for (std::size_t first = in.first; first < in.last; first += kBatchPlaces) {
            const std::size_t last = std::min(in.last, first + kBatchPlaces);
            if (batches.empty() || first > in.first || batches.back().size() == kBatchCells ||
                places + (last - first) > kBatchPlaces) {
                batches.emplace_back();
                places = 0;
            }
            batches.back().push_back({in.cell, first, last});
            places += last - first;
        }
    }
    return batches;
}

void RefinedStore::run(const Batch& batch, const DescentTask& task, const std::shared_ptr<ClassGraph>& classes, bool keep,
                       DescentWorkers& workers) {
    std::vector<Octants> octants(batch.size(), Octants{});
    std::vector<std::uint8_t> missing(batch.size());
    parallel_each(batch.size(), [&](std::size_t i) { missing[i] = octants_of(task, batch[i]); });
    {
        const std::shared_lock lock(mutex_);
        for (std::size_t i = 0; i < batch.size(); ++i) {
            if (!kept_[batch[i].cell]) continue;
            octants[i] = *kept_[batch[i].cell];
            for (std::size_t o = 0; o < 8; ++o) {
                if (octants[i][o] != nullptr) missing[i] &= static_cast<std::uint8_t>(~(1U << o));
            }
        }
    }
    std::shared_ptr<const RefinedCells> refined;
    refine(batch, missing, classes, keep, refined, octants);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, batch.size(), 4), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            DescentWorker& with = workers.local();
            const bool regular = mesh_.load(batch[i].cell, with.jets());
            const auto places = with.evaluate(with.open(batch[i]), kIdentityTurn, 0, regular);
            each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
                const RefinedOctant& in = *octants[i][octant];
                in.cells->run(in, inside, with);
            });
        }
    });
}

/// Refines what is missing, into a piece of its own.
void RefinedStore::refine(const Batch& batch, std::span<const std::uint8_t> missing, const std::shared_ptr<ClassGraph>& classes,
                          bool keep, std::shared_ptr<const RefinedCells>& refined, std::span<Octants> octants) {
    std::vector<std::size_t> numbers;  // in the batch
    std::vector<Index> cells;
    std::vector<std::uint8_t> wanted;
    for (std::size_t i = 0; i < batch.size(); ++i) {
        if (missing[i] == 0) continue;
        numbers.push_back(i);
        cells.push_back(batch[i].cell);
        wanted.push_back(missing[i]);
    }
    if (cells.empty()) return;
    refined = std::make_shared<const RefinedCells>(mesh_, source_, classes, cells, wanted);
    const auto add = [&](std::size_t n, Octants& to) {
        for (std::size_t o = 0; o < 8; ++o) {
            if ((wanted[n] >> o & 1) != 0) to[o] = &refined->octant(n, o);
        }
    };
    for (std::size_t n = 0; n < cells.size(); ++n) add(n, octants[numbers[n]]);
    if (!keep) return;
    const std::size_t bytes = refined->bytes();
    const std::scoped_lock lock(mutex_);
    if (bytes_ + bytes > kMostBytesOfStore) return;
    bytes_ += bytes;
    pieces_.push_back(refined);
    for (std::size_t n = 0; n < cells.size(); ++n) {
        auto& kept = kept_[cells[n]];
        if (!kept) kept = std::make_unique<Octants>();
        add(n, *kept);
    }
}

}  // namespace subvol::detail
