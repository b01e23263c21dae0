// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "descent_worker.h"

namespace subvol::detail {

/// Evaluates the limit at places, from class to class (`ClassGraph`).
///
///     level 0   cells inside a grid ────────────────► the regular class, level by level
///               cells of a class that is common ────► that class, level by level
///               splines on a grid, linear cells: exact at once
///               the others: refined twice (`RefinedStore`)
///     level 2   the class of the neighbourhood of the descendant that has the place, and of its children …
///
/// A descendant is evaluated by a cubic through its regular grid, or trilinearly where there is none, until two levels agree.
/// Places in one cell share its descendants; the arithmetic of a place does not depend on the others.
class LimitDescents {
public:
    /// What is the same for all places: topology, and the classes that have been met. The mesh is kept by reference.
    ///
    /// by_frequency: classes with many cells have tables from level 0 on, which changes last bits. Otherwise those of cells in
    /// a
    ///               box of a grid have them, and a result depends on nothing but the three layers of cells around its own
    LimitDescents(const HexMesh& control, const SchemeOptions& scheme, bool by_frequency);
    ~LimitDescents();
    LimitDescents(const LimitDescents&) = delete;
    LimitDescents& operator=(const LimitDescents&) = delete;

    /// Fills the samples of the task, whose mesh and scheme are those above. Returns the queries whose surroundings have no
    /// class: those are left to the caller. Several threads may call it.
    ///
    /// keep: what had to be refined, for the next call
    [[nodiscard]] std::vector<LeftPlace> run(const DescentTask& task, std::span<const CellPlaces> cells, bool keep) const;

    /// The classes so far.
    [[nodiscard]] std::shared_ptr<ClassGraph> classes() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol::detail
