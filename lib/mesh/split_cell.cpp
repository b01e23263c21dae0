// SPDX-License-Identifier: Apache-2.0
#include "subvol/cell.h"

#include <algorithm>

namespace subvol {

std::array<std::array<Index, 4>, 6> split_cell(const std::array<Index, 8>& cell) {
    const auto apex = *std::min_element(cell.begin(), cell.end());
    std::array<std::array<Index, 4>, 6> tets;
    std::size_t count = 0;
    for (const auto& face : kCellFaces) {
        std::array<Index, 4> quad;
        for (std::size_t k = 0; k < 4; ++k) quad[k] = cell[static_cast<std::size_t>(face[k])];
        if (std::find(quad.begin(), quad.end(), apex) != quad.end()) continue;
        std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
        // The quad is counter-clockwise from outside and the apex lies behind it: (0,2,1) turns its base inwards.
        tets[count++] = {quad[0], quad[2], quad[1], apex};
        tets[count++] = {quad[0], quad[3], quad[2], apex};
    }
    return tets;
}

}  // namespace subvol
