// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stencil_row.h"

namespace subvol::detail {

/// The points of a child's neighbourhood as sums over those of its parent's. Rows come in the order in which they are asked
/// for; terms of one weight are added up before they are multiplied.
///
///     row i is the child's point points[i] = Σ weights[r] · (columns of run r),   runs run_ends[i − 1] .. run_ends[i]
struct StepTable {
    std::vector<std::uint16_t> points;
    std::vector<std::uint32_t> run_ends;
    std::vector<double> weights;
    std::vector<std::uint16_t> counts;  // columns of each run
    std::vector<std::uint32_t> column_ends;  // of each row
    std::vector<std::uint16_t> columns;
    std::size_t near = 0;  // so many rows come first: those of the points that the child is evaluated from

    void add(std::size_t point, const StencilRuns& row);
    [[nodiscard]] std::size_t bytes() const;
};

/// Applies rows [first, last) to all channels of one neighbourhood: channel c of point p is at p·stride + c, in `in` and `out`.
///
/// stride: a multiple of 4
void apply_step(const StepTable& table, std::size_t first, std::size_t last, std::size_t stride, const double* in, double* out);

}  // namespace subvol::detail
