// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/limit_level.h"

namespace subvol::detail {

/// Layers of cells about a cell that values and gradients of its limit depend on.
inline constexpr int kHaloOfLimit = 3;

/// What tolerances of the limit are relative to.
///
/// box:    of the points that cells use
/// ranges: least and largest value of each attribute at these points, of all channels together
struct LimitExtent {
    Box box{};
    std::vector<std::array<double, 2>> ranges{};

    /// Of two parts of a mesh, which have the same attributes; one that is empty has none.
    void add(const LimitExtent& more);
};

[[nodiscard]] LimitExtent limit_extent(const HexMesh& mesh);

/// `find_limit_cells` for a part of a mesh: its cells are cut as in the whole mesh, as values are compared with their ranges
/// there.
///
/// ranges: least and largest value of each attribute in the whole mesh, of all channels together
[[nodiscard]] LimitCells find_limit_cells(const HexMesh& part, RefineOptions refinement, const LimitCellsOptions& options,
                                          std::span<const std::array<double, 2>> ranges);

}  // namespace subvol::detail
