#pragma once

#include <array>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// Splits a cell into 6 tetrahedra about its smallest-id corner: the three faces away from that corner take the diagonal of
/// their own smallest id, so neighbours agree on any mesh. Tetrahedra are positively oriented where the cell is.
///
/// returns: 6 × 4 point ids
[[nodiscard]] std::array<std::array<Index, 4>, 6> split_cell(const std::array<Index, 8>& cell);

}  // namespace subvol
