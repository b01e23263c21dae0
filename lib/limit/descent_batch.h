// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <vector>

#include "descent_worker.h"
#include "patch.h"

namespace subvol::detail {

using DescentWorkers = tbb::enumerable_thread_specific<DescentWorker>;

/// Loads a cell of the control mesh, by its regular grid if it has one. Returns whether it has.
///
/// rows: the channels of the control points
[[nodiscard]] bool load_control_cell(const DescentTask& task, const Topology& topology, std::span<const double> rows,
                                     Index cell, CellJets& jets);

/// A batch of control cells without a common class. They are refined twice where places need it; the descendants of level 2
/// have classes.
class DescentBatch {
public:
    /// control_rows: the channels of the control points. All references are kept.
    DescentBatch(const DescentTask& task, const Topology& topology, std::span<const double> control_rows, ClassGraph& classes,
                 DescentWorkers& workers);

    void run(const PatchSource& source, std::span<const CellPlaces> cells);

private:
    /// A cell of level 1 that has places, with the walk about it. entry: null if there is none
    struct Parent {
        const ClassEntry* entry = nullptr;
        std::uint8_t turn = kIdentityTurn;
        std::vector<Index> points{};
        std::vector<NeighborhoodWalk::Visited> visited{};
    };
    [[nodiscard]] std::vector<Index> find_parents(const Patch& first, const Topology& topology,
                                                  std::span<const CellPlaces> cells);
    void run_cell(const CellPlaces& in, std::size_t number, DescentWorker& with) const;
    void enter(const Parent& parent, std::span<OpenPlace> places, DescentWorker& with) const;

    const DescentTask& task_;
    const Topology& topology_;
    std::span<const double> control_rows_;
    ClassGraph& classes_;
    DescentWorkers& workers_;
    std::vector<Parent> parents_;  // eight for each cell
    std::vector<Index> slots_;     // of cells of level 1 among the refined ones
    HexMesh second_;
    std::vector<double> first_rows_, second_rows_;
};

/// All channels of the points of a mesh.
[[nodiscard]] std::vector<double> rows_of(const HexMesh& mesh, std::size_t stride);

}  // namespace subvol::detail
