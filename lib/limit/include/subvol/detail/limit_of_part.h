// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "subvol/limit_level.h"

namespace subvol::detail {

/// `find_limit_cells` for a part of a mesh: its cells are cut as in the whole mesh, as values are compared with their ranges
/// there.
///
/// ranges: least and largest value of each attribute in the whole mesh, of all channels together
[[nodiscard]] LimitCells find_limit_cells(const HexMesh& part, RefineOptions refinement, const LimitCellsOptions& options,
                                          std::span<const std::array<double, 2>> ranges);

}  // namespace subvol::detail
