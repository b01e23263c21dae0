// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "subvol/topology.h"

namespace subvol::detail {

/// The six tetrahedra of a cell, by corner numbers of the cell: corner k of tetrahedron t is corners[k][t]. Two copies of the
/// last one fill vectors of eight.
struct CornerSplit {
    std::array<std::array<std::int64_t, 8>, 4> corners;
};

/// diagonals: bit f is set if face f of those away from the apex is cut from its corner 1 to 3, else it is cut from 0 to 2
[[nodiscard]] const CornerSplit& corner_split(std::size_t apex, std::size_t diagonals);

/// The three faces that do not touch a corner, in the order of `kCellFaces`.
[[nodiscard]] const std::array<std::array<int, 4>, 3>& faces_away_from(std::size_t corner);

/// The tetrahedra of `split_cell`. less: any order of the corners that is the same in all cells that share them
template <class Less>
const CornerSplit& corner_split(const Less& less) {
    std::size_t apex = 0;
    for (std::size_t k = 1; k < 8; ++k) {
        if (less(k, apex)) apex = k;
    }
    std::size_t diagonals = 0;
    const auto& faces = faces_away_from(apex);
    for (std::size_t f = 0; f < 3; ++f) {
        std::size_t least = 0;
        for (std::size_t k = 1; k < 4; ++k) {
            if (less(static_cast<std::size_t>(faces[f][k]), static_cast<std::size_t>(faces[f][least]))) least = k;
        }
        diagonals |= (least & 1) << f;
    }
    return corner_split(apex, diagonals);
}

}  // namespace subvol::detail
