// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "subvol/detail/sparse_rows.h"

namespace subvol::detail {

/// Numbers of several channels, which are fitted together: the matrices are read once for all of them.
constexpr std::size_t kLanes = 4;
using Lanes = std::array<double, kLanes>;

using LaneMatrix = SparseRows<float>;

[[nodiscard]] Lanes dot(const std::vector<Lanes>& a, const std::vector<Lanes>& b);
[[nodiscard]] Lanes largest(const std::vector<Lanes>& values);

struct LaneSearch {
    double tie = 0;          ///< how much a change counts beside what is off
    Lanes enough{};          ///< the search of a lane ends when nothing is off by more than this
    int max_iterations = 0;  ///< the most iterations of each search
};

/// Changes the values by conjugate gradients of the least squares |rows · values − wanted|² + tie |change|².
///
/// columns: the transposed rows
/// off:     wanted − rows · values, before and after
/// free:    1 where a value may change, 0 where it stays
/// returns: the steps of the longest search
int search(const LaneMatrix& rows, const LaneMatrix& columns, const std::vector<Lanes>& free, std::vector<Lanes>& values,
           std::vector<Lanes>& off, const LaneSearch& options);

}  // namespace subvol::detail
