// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Cells of a regular block, from `begin` to before `end` on each axis.
struct CellRange {
    std::array<std::uint64_t, 3> begin{}, end{};

    [[nodiscard]] bool contains(const std::array<std::uint64_t, 3>& cell) const {
        for (std::size_t d = 0; d < 3; ++d) {
            if (cell[d] < begin[d] || cell[d] >= end[d]) return false;
        }
        return true;
    }
};

/// Some cells of the model `twist` of n³ cells, x fastest: points and values have the bits of the whole model's.
[[nodiscard]] HexMesh twist_block(std::uint64_t n, const CellRange& cells);

}  // namespace subvol::detail
