// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/detail/cell_tables.h"
#include "table_rows.h"

namespace subvol::detail {

/// The rows of places in control cells whose neighbourhoods are alike in many places of the mesh: such cells share a table from
/// the points around a cell to the points of level L in it. Nothing of the finer levels is stored, so a cell takes about a
/// kilobyte, and the table is applied to sixteen cells at a time.
class ClassRows {
public:
    /// options, settling: as of TableRows
    ClassRows(const HexMesh& mesh, const RefineOptions& options, std::span<const LimitQuery> places, const Settling& settling);

    /// A flag for each cell with places that has no common class: their rows are not among these.
    [[nodiscard]] const std::vector<std::uint8_t>& rest() const { return rest_; }

    /// Writes its rows of A x.
    void apply(std::span<const double> control, std::span<double> values) const;
    /// Adds what its rows give to Aᵀ y.
    void add_transposed(std::span<const double> values, std::vector<double>& sums) const;

private:
    struct Place {
        Vec3 at;             ///< place among its 27 nodes in the grid of the cell
        Index row;           ///< row of the matrix
        std::uint16_t node;  ///< the lowest of these nodes
    };

    /// Those rows of a class's table that some cells need, and their transpose.
    struct Table {
        /// The points of the neighbourhood that have weights; columns of `values`, rows of `transposed`
        std::vector<std::uint16_t> used;
        std::vector<std::uint16_t> rows;  ///< for each node of the grid its row in `values`; 0 for nodes that nobody needs
        WeightTable values, transposed;
    };

    /// Up to kTableLanes cells with the same table.
    struct Chunk {
        Index table, first, count;
    };

    /// Which rows of its class's table a cell needs: bits 0 to 7 for the octants with places, bit 8 for nodes of level L
    /// itself.
    using Need = std::uint16_t;

    struct Scratch;
    struct Finding;
    void settle(Finding& finding, const Settling& settling);
    void choose_tables(Finding& finding);
    [[nodiscard]] Table table_of(const WeightTable& whole, Need need) const;
    [[nodiscard]] Need need_of(std::span<const Place> places) const;
    [[nodiscard]] std::span<const Place> places_in(std::size_t member) const;
    void load(const Chunk& chunk, std::span<const double> control, Scratch& scratch) const;
    template <class Visit>
    void each_term(const Place& place, const Table& table, const Visit& visit) const;

    std::size_t levels_, side_;  // of the grid of a cell
    std::size_t columns_;
    std::vector<std::uint8_t> rest_;
    Classified cells_;
    Rows<Place> places_;  // of each cell
    std::vector<Table> tables_;
    std::vector<Chunk> chunks_;
};

}  // namespace subvol::detail
