// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "step_table.h"
#include "subvol/detail/class_tables.h"
#include "subvol/detail/neighborhood.h"
#include "subvol/detail/regular_grid.h"
#include "subvol/scheme.h"

namespace subvol::detail {

struct DescentClass;

/// How the neighbourhoods of a cell's children follow from that of the cell.
struct ClassChildren {
    struct Child {
        /// The child's class; null if its neighbourhood has none (see NeighborhoodWalk::find)
        const DescentClass* to = nullptr;
        std::uint8_t turn = kIdentityTurn;  ///< from the axes of the child's walk to those of the parent's
        StepTable near{};                   ///< makes the points that a place in the child is evaluated from
        StepTable rest{};                   ///< makes the other points of its neighbourhood
    };
    std::array<Child, 8> children{};  // by octants along the axes of the parent's walk
};

/// A class of neighbourhoods of two layers. Its points are numbered by the walk; the first eight are the cell's own, at octants
/// u + 2v + 4w of the walk, unless it is the regular class, whose 6×6×6 points are those of NeighborhoodWalk::find_regular.
struct DescentClass {
    Neighborhood about{};
    bool on_grid = false;  ///< whether the cell's surroundings are regular_grid, whose numbers `grid` has
    GridPoints grid{};
    mutable std::atomic<const ClassChildren*> children{nullptr};  ///< once they are made

    [[nodiscard]] std::size_t point_count() const { return about.points.size(); }
};

/// The children of a cell whose neighbourhood of one layer is known: the way into the classes of the next level, whose weights
/// would depend on two layers.
struct ClassEntry {
    struct Corner {
        std::uint16_t cell;          // in the order of the walk
        std::uint8_t child, corner;  // octants along the axes of the walk
    };
    struct Child {
        const DescentClass* to = nullptr;
        std::uint8_t turn = kIdentityTurn;  // from the axes of the child's walk to those of the parent's
        std::vector<std::uint16_t> rows{};  // of `points`
    };
    /// Whether the cell's surroundings are regular_grid, whose numbers among the walk's points `grid` has
    bool on_grid = false;
    GridPoints grid{};
    /// Points of the children's neighbourhoods, each once, as corners of children of the cells that the walk around the parent
    /// visits
    std::vector<Corner> points{};
    std::array<Child, 8> children{};  ///< by octants
};

/// Which classes the children of a class belong to, and how their points follow: a place in a cell is found by a walk from
/// class to class, without topology. Around an extraordinary edge or point most children are regular, and the others have the
/// class of their parent or one of a few others, so that the graph is small however deep the walk goes.
///
/// Everything is made when it is asked for first, from the neighbourhood's code alone, so that it does not depend on who asks.
/// Thread-safe.
class ClassGraph {
public:
    explicit ClassGraph(const SchemeOptions& scheme);
    ~ClassGraph();
    ClassGraph(const ClassGraph&) = delete;
    ClassGraph& operator=(const ClassGraph&) = delete;

    [[nodiscard]] const DescentClass& regular() const;
    /// The class of a neighbourhood of two layers.
    [[nodiscard]] const DescentClass& class_of(const Neighborhood& about);
    [[nodiscard]] const ClassChildren& children(const DescentClass& parent);
    /// about: of one layer
    [[nodiscard]] const ClassEntry& entry(const Neighborhood& about);

    /// Returns the size of all tables.
    [[nodiscard]] std::size_t bytes() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol::detail
