// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stencil_row.h"

namespace subvol::detail {

/// The points of a cell's refinement as sums over those of its neighbourhood.
///
///     row i is Σ weights[n] · (point columns[n]),   n = begins[i] .. begins[i + 1],
///     a multiple of 4 terms: the last ones may have no weight
struct StepTable {
    static constexpr std::size_t kTerms = 4;
    std::vector<std::uint32_t> begins{0};
    std::vector<double> weights;
    std::vector<std::uint16_t> columns;

    [[nodiscard]] std::size_t rows() const { return begins.size() - 1; }
    void add(const StencilRuns& row);
    [[nodiscard]] std::size_t bytes() const;
};

/// Rows of a table that have been computed for one neighbourhood.
struct StepRows {
    std::vector<double> values;        // channel c of row i at i·stride + c
    std::vector<std::uint32_t> marks;  // of the rows that are there: mark
    std::uint32_t mark = 0;

    /// Forgets all rows.
    void begin(const StepTable& table, std::size_t stride);
};

/// Computes those of the rows that are not there yet.
///
/// stride: of `in` and of the rows, a multiple of 4
void apply_step(const StepTable& table, std::span<const std::uint16_t> rows, std::size_t stride, const double* in,
                StepRows& to);

}  // namespace subvol::detail
