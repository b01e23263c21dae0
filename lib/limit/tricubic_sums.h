// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "mcq_block.h"
#include "regular_grid.h"

namespace subvol::detail {

/// Weights of four grid points at −1, 0, 1, 2 for a parameter in [0,1], and their derivatives.
struct CubicWeights {
    std::array<double, 4> value{}, first{};
};

/// The sum over 4×4×4 points and its derivatives along the three axes: the jet's rows one after the other.
///
/// points: rows of `stride` channels, a multiple of 4; grid: the numbers of the rows, u fastest; scale: of the derivatives
void sum_tricubic(const double* points, const GridPoints& grid, std::size_t stride, const std::array<CubicWeights, 3>& weights,
                  double scale, double* jet);

/// The same over the points at (0, 0, 0) to (3, 3, 3) of a grid.
void sum_tricubic(const GridRows& grid, const std::array<CubicWeights, 3>& weights, double scale, double* jet);

}  // namespace subvol::detail
