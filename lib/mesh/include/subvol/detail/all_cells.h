// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numeric>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// The numbers of a mesh's cells.
inline std::vector<Index> all_cells(const HexMesh& mesh) {
    std::vector<Index> cells(mesh.cells.size());
    std::iota(cells.begin(), cells.end(), Index{0});
    return cells;
}

}  // namespace subvol::detail
