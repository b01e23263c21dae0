// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <memory>
#include <shared_mutex>
#include <vector>

#include "descent_worker.h"
#include "subvol/detail/patch.h"

namespace subvol::detail {

/// The mesh of the control points, and what is made of it once.
struct DescentMesh {
    const HexMesh& control;
    SchemeOptions scheme;
    std::size_t stride;  ///< of rows
    Topology topology;
    CellLinks links;
    std::vector<double> rows;  ///< the channels of the points

    /// color_rounds: of the links
    DescentMesh(const HexMesh& mesh, const SchemeOptions& with, int color_rounds);

    /// Loads a cell, by its regular grid if it has one. Returns whether it has.
    [[nodiscard]] bool load(Index cell, CellJets& jets) const;
};

class RefinedCells;

/// A cell of level 1, with the walk around it.
struct RefinedOctant {
    const RefinedCells* cells = nullptr;  ///< the cells that it was refined with
    const ClassEntry* entry = nullptr;    ///< null if it has no class, or is not wanted
    std::uint8_t turn = kIdentityTurn;
    std::vector<Index> points{};  ///< the points that it is evaluated from
    std::vector<NeighborhoodWalk::Visited> visited{};
};

/// Control cells without a common class, refined twice: the descendants of level 2 have classes.
class RefinedCells {
public:
    /// The mesh is kept by reference.
    ///
    /// octants: of each cell those that will have places (bit by bit)
    RefinedCells(const DescentMesh& mesh, const PatchSource& source, std::shared_ptr<ClassGraph> classes,
                 std::span<const Index> cells, std::span<const std::uint8_t> octants);
    RefinedCells(const RefinedCells&) = delete;
    RefinedCells& operator=(const RefinedCells&) = delete;

    /// number: of the cell, in the order that they were given
    [[nodiscard]] const RefinedOctant& octant(std::size_t number, std::size_t octant) const;

    /// Evaluates places in one of its octants. Thread-safe.
    void run(const RefinedOctant& in, std::span<OpenPlace> places, DescentWorker& with) const;

    [[nodiscard]] std::size_t bytes() const;

private:
    [[nodiscard]] std::vector<Index> find_octants(const Patch& first, const Topology& topology,
                                                  std::span<const std::uint8_t> octants);
    void enter(const RefinedOctant& parent, std::span<OpenPlace> places, DescentWorker& with) const;

    const DescentMesh& mesh_;
    std::shared_ptr<ClassGraph> classes_;
    std::vector<RefinedOctant> octants_;  // as children of their cells, eight for each
    std::vector<Index> slots_;            // of cells of level 1 among the refined ones
    std::vector<std::array<Index, 8>> second_cells_;
    std::vector<double> first_rows_, second_rows_;
};

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
