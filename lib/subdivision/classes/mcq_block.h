// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "subvol/index.h"

namespace subvol::detail {

/// Points of a grid, as rows of channels: row i + side·(j + side·k) for the point at (i, j, k).
struct GridRows {
    const double* rows;
    std::size_t side;
    std::size_t stride;  ///< numbers per row, a multiple of 4

    /// The part that begins at a point.
    [[nodiscard]] GridRows from(const std::array<std::size_t, 3>& at) const {
        return {rows + (at[0] + side * (at[1] + side * at[2])) * stride, side, stride};
    }
};

/// Refines a cell of a grid by the regular masks of MCQ. Sums that several new points have in common are formed once: ten
/// operations a point where its row has 24 terms. Points have the same bits whichever of these functions makes them.
///
/// from: begins two points before the cell, on every axis; six points are read
/// to:   7³ rows, which begin two new points before the cell and end two after it
void refine_mcq_cell(double tension, const GridRows& from, double* to);

/// The same for 2³ cells, to 9³ rows.
void refine_mcq_cells(double tension, const GridRows& from, double* to);

/// The 6×6×6 new points around one child of a cell. octant: u + 2v + 4w of the child
void refine_mcq_child(double tension, const GridRows& from, std::size_t octant, double* to);

}  // namespace subvol::detail
