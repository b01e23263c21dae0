// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "subvol/dense_cells.h"
#include "subvol/detail/cell_links.h"

namespace subvol::detail {

/// Refines the cells of a control mesh one by one, into grids of vertices.
///
/// Cells whose neighbourhoods are alike share a table of weights (`ClassTables`), which is applied to many of them side by
/// side. The others, too few of a kind for a table to pay, are refined once together, and their children, most of which have
/// more in common, take their place: around an extraordinary edge only the cells at the edge stay irregular.
///
///     level 0   common classes ──────────────► tables of `levels` levels
///               rare ones ─► level 1  common classes ──► tables of `levels` − 1 levels
///                                     rare ones ─► level 2 …  the last level is refined, or read off
class CellRefiner {
public:
    /// How far cells are refined, cell by cell and child by child. Called from several threads at once.
    struct Descent {
        /// Gets the grid of level 1 of each cell; returns whether it is to be refined further
        std::function<bool(const DenseCell& cell)> cell;
        /// Gets the grid of level 2 of such a cell; returns its children that are to be refined further, bit k: child k
        std::function<std::uint8_t(const DenseCell& cell)> whole;
        /// Gets the grid of such a child, of `levels` levels: 2 first, then as long as it returns true one more
        std::function<bool(const DenseCell& cell, std::size_t child, int levels)> part;
    };

    /// control:  must be valid; is kept by reference
    /// on_limit: vertices are moved to the limit where the scheme does not interpolate
    CellRefiner(const HexMesh& control, const SchemeOptions& scheme, bool on_limit);
    ~CellRefiner();
    CellRefiner(CellRefiner&&) noexcept;
    CellRefiner& operator=(CellRefiner&&) noexcept;

    /// Calls visit for each of the cells, from several threads at once and in no order. Which cells share a table depends on
    /// the list of cells, and so do the last bits of the results; not on the number of threads.
    ///
    /// tables: Regular: up to level 2 regular cells alone have one; Common: all classes with many members do
    enum class Tables : std::uint8_t { Regular, Common };
    void for_each(std::span<const Index> cells, int levels, Progress* progress,
                  const std::function<void(const DenseCell&)>& visit, Tables tables = Tables::Regular) const;

    /// What lies across the sides of the cells.
    [[nodiscard]] const CellLinks& links() const;

    /// Refines these cells to level 1, and further as far as the visitor asks for it, up to level most_levels.
    ///
    /// cells: without repetition; where they are a multiple of kRun, regular cells share tables as if all cells were given
    void descend(std::span<const Index> cells, int most_levels, Progress* progress, const Descent& visitor) const;
    static constexpr std::size_t kRun = std::size_t{1} << 16;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol::detail
