// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <shared_mutex>

#include "refined_cells.h"

namespace subvol::detail {

using DescentWorkers = tbb::enumerable_thread_specific<DescentWorker>;

/// Refines cells for places, and keeps them for the next call, as far as there is room.
class RefinedStore {
public:
    /// The mesh is kept by reference.
    explicit RefinedStore(const DescentMesh& mesh);

    /// Cells that are near each other in space, with their places.
    using Batch = std::vector<CellPlaces>;
    [[nodiscard]] std::vector<Batch> batches(std::span<const CellPlaces> cells) const;

    /// Evaluates the places of a batch. Thread-safe; what is kept changes no result.
    void run(const Batch& batch, const DescentTask& task, const std::shared_ptr<ClassGraph>& classes, bool keep,
             DescentWorkers& workers);

private:
    using Octants = std::array<const RefinedOctant*, 8>;
    void refine(const Batch& batch, std::span<const std::uint8_t> missing, const std::shared_ptr<ClassGraph>& classes,
                bool keep, std::shared_ptr<const RefinedCells>& refined, std::span<Octants> octants);

    const DescentMesh& mesh_;
    PatchSource source_;
    std::shared_mutex mutex_;
    std::vector<std::unique_ptr<Octants>> kept_;  // by cells
    std::vector<std::shared_ptr<const RefinedCells>> pieces_;
    std::size_t bytes_ = 0;  // of the pieces
};

}  // namespace subvol::detail
