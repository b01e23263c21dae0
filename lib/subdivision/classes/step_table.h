// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "subvol/stencil_table.h"

namespace subvol::detail {

/// Rows that make the points of a cell's refinement from those of its neighbourhood, four at a time.
///
/// Most rows are one of a few masks: rows with the same weights stand together, and the weights once for all of them. So a
/// table takes two bytes a term and stays in the caches however many classes there are.
class StepTable {
public:
    /// A row of a block, and the number of the point that it makes.
    struct Row {
        std::uint32_t row;
        std::uint16_t to;
    };

    StepTable() = default;
    StepTable(const StencilTable::Block& block, std::span<const Row> rows);

    /// Computes the points.
    ///
    /// stride: numbers of a point in `from` and `to`, a multiple of 4
    void apply(std::size_t stride, const double* from, double* to) const;

    [[nodiscard]] std::size_t bytes() const;

    static constexpr std::size_t kRows = 4;
    /// Up to kRows rows with as many terms; missing ones repeat the first.
    struct Group {
        /// Where they begin; term t of row r has column kRows·t + r, four times the number of its point
        std::uint32_t weights, columns;
        std::uint16_t terms;  ///< even; the last may have no weight
        bool same;            ///< all rows have the weights 0, 1, 2 …; otherwise weights are ordered as columns are
        std::array<std::uint16_t, kRows> to;
    };

private:
    struct Source;
    void add_group(std::span<const Source> rows, bool same, std::size_t weights);

    std::vector<Group> groups_;
    std::vector<double> weights_;
    std::vector<std::uint16_t> columns_;
};

}  // namespace subvol::detail
