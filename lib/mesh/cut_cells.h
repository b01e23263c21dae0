// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/mixed_cells.h"

namespace subvol::detail {

/// Makes all cells right-handed: exchanges corners of those whose volume is negative.
void orient_mixed(std::span<const Vec3> points, std::vector<std::array<Index, 8>>& hexes, MixedCells& others);

/// parents: as in HexSplit
struct CutCells {
    std::vector<std::array<Index, 4>> tets;
    std::vector<Index> parents;
};

/// Cuts right-handed cells into right-handed tetrahedra. Quads are cut along the diagonal from their smallest id, so that
/// neighbours agree.
[[nodiscard]] CutCells cut_to_tets(const std::vector<std::array<Index, 8>>& hexes, const MixedCells& others);

}  // namespace subvol::detail
