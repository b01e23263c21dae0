// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <compare>
#include <span>
#include <vector>

#include "class_graph.h"
#include "jets.h"
#include "mcq_block.h"

namespace subvol::detail {

/// The places of one control cell: queries[first .. last) of a list that is sorted by cells.
struct CellPlaces {
    Index cell;
    std::size_t first, last;
};

/// A query that the classes have not evaluated to the end.
struct LeftPlace {
    std::size_t query;
    int level;  ///< level of the first descendant that has no class
    auto operator<=>(const LeftPlace&) const = default;
};

/// What is asked for, of which mesh.
struct DescentTask {
    const HexMesh& control;
    std::span<const LimitQuery> queries;
    std::span<const std::size_t> order;  ///< the numbers of the queries, sorted by cells
    const LimitOptions& options;
    std::span<const double> scales;  ///< for each channel, what tolerances are relative to
    LimitSamples& samples;
    std::span<const Vec3> targets{};  ///< if not empty, the position that each query approaches
    std::span<Vec3> moved{};          ///< by how much each query has moved in its cell
    Channels channels{control};

    [[nodiscard]] bool is_spline() const { return !interpolates(options.scheme.kind); }
};

/// Evaluates places in a cell of a class, and in its descendants as deep as they ask for it. Each thread has its own.
///
///     a class   its children's neighbourhoods by the class's tables, as far as they are needed
///     a grid    by the masks of MCQ, block by block: no table, no rows
///
/// The arithmetic of a place does not depend on the others.
class DescentWorker {
public:
    /// The task is kept by reference.
    explicit DescentWorker(const DescentTask& task);

    /// The places of a cell, with memory for their jets.
    [[nodiscard]] std::span<OpenPlace> open(const CellPlaces& in);

    /// Memory for the rows of a neighbourhood at a level.
    [[nodiscard]] double* values(int level, std::size_t rows);

    /// Loads the cell that is evaluated next.
    CellJets& jets() { return jets_; }
    /// Moves places towards their targets, if the task has some, as far as the cell that is loaded goes. turn: as below
    void approach(std::span<OpenPlace> places, std::uint8_t turn, int level);

    /// Evaluates places in the cell that is loaded. Those that are open are moved to the front and returned.
    ///
    /// turn: from the axes of the loaded cell to those of the control cell
    [[nodiscard]] std::span<OpenPlace> evaluate(std::span<OpenPlace> places, std::uint8_t turn, int level, bool on_grid);

    /// Places in a cell of a class, the rows of whose neighbourhood are in values(level).
    void begin(const DescentClass& is, std::uint8_t turn, int level, std::span<OpenPlace> places, ClassGraph& classes);

    /// Notes places whose surroundings have no class at a level.
    void leave(std::span<const OpenPlace> places, int level);
    [[nodiscard]] const std::vector<LeftPlace>& left() const { return left_; }

    [[nodiscard]] LimitReport& report() { return settling_.report(); }

private:
    [[nodiscard]] const double* jet_at(const Vec3& uvw, std::uint8_t turn, double scale);
    [[nodiscard]] bool step_to_target(OpenPlace& at, const double* jet, double scale) const;
    void load(const DescentClass& is, const double* rows);
    void descend(const DescentClass& is, std::uint8_t turn, int level, std::span<OpenPlace> places, ClassGraph& classes);
    void descend_grid(const GridRows& about, std::uint8_t turn, int level, std::span<OpenPlace> places);
    void descend_twice(const GridRows& about, std::uint8_t turn, int level, std::span<OpenPlace> places);

    const DescentTask& task_;
    std::size_t stride_;
    Settling settling_;
    CellJets jets_;
    std::vector<std::vector<double>> values_;  // of the neighbourhoods on the way down
    std::vector<OpenPlace> places_;
    std::vector<double> lasts_, jet_, turned_, child_;
    std::vector<LeftPlace> left_;
};

/// The octant of the walk that is a cell's octant `octant`.
[[nodiscard]] std::size_t walk_octant(std::uint8_t turn, std::size_t octant);

/// Moves the places into the children of their cell and calls visit(octant, places) for those that have any.
template <class Visit>
void each_octant(std::span<OpenPlace> places, const Visit& visit) {
    for (OpenPlace& at : places) at.step_down();
    if (places.size() > 1) std::ranges::sort(places, {}, &OpenPlace::octant);
    for (std::size_t first = 0; first < places.size();) {
        std::size_t last = first + 1;
        while (last < places.size() && places[last].octant == places[first].octant) ++last;
        visit(std::size_t{places[first].octant}, places.subspan(first, last - first));
        first = last;
    }
}

}  // namespace subvol::detail
