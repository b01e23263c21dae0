// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "subvol/stencil_table.h"

namespace subvol::detail {

/// Rows of a table in any order.
class RowAccess {
public:
    /// The table is kept by reference. cost: parallel; 8 bytes a row
    explicit RowAccess(const StencilTable& table);

    /// Calls visit(point, weight) for the terms of a row.
    template <class Visit>
    void terms(std::size_t row, const Visit& visit) const {
        if (row < table_.kept()) return visit(static_cast<Index>(row), 1.0);
        const auto after = std::upper_bound(first_rows_.begin(), first_rows_.end(), row);
        const auto b = static_cast<std::size_t>(after - first_rows_.begin()) - 1;
        const StencilTable::Block& block = table_.blocks()[b];
        const std::size_t i = row - block.first_row, pattern = block.row_patterns[i];
        const Index* point = block.points.data() + starts_[b][i];
        for (std::size_t r = block.pattern_offsets[pattern]; r < block.pattern_offsets[pattern + 1]; ++r) {
            for (std::uint32_t k = 0; k < block.runs[r].count; ++k) visit(*point++, block.runs[r].weight);
        }
    }

private:
    const StencilTable& table_;
    std::vector<std::vector<std::size_t>> starts_;
    std::vector<std::size_t> first_rows_;
};

}  // namespace subvol::detail
