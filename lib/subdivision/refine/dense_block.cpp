// SPDX-License-Identifier: Apache-2.0
#include "dense_block.h"

#include "subvol/cell.h"

namespace subvol::detail {

DenseBlock::DenseBlock(int levels) : side_((std::size_t{1} << levels) + 1), lowest_(std::size_t{1} << (3 * levels)) {
    for (std::size_t d = 0; d < lowest_.size(); ++d) {
        std::array<std::size_t, 3> uvw{};
        for (int level = 1; level <= levels; ++level) {  // the leading octal digit is the child of the first split
            const std::size_t child = d >> (3 * (levels - level)) & 7;
            for (std::size_t a = 0; a < 3; ++a) {
                uvw[a] += static_cast<std::size_t>(kCornerParameters[child][a]) << (levels - level);
            }
        }
        lowest_[d] = static_cast<std::uint32_t>(uvw[0] + side_ * (uvw[1] + side_ * uvw[2]));
    }
}

void DenseBlock::nodes(const HexMesh& refined, std::size_t first, std::vector<Index>& points) const {
    points.resize(node_count());
    std::array<std::size_t, 8> step;
    for (std::size_t k = 0; k < 8; ++k) {
        const auto& [u, v, w] = kCornerParameters[k];
        step[k] = static_cast<std::size_t>(u) + side_ * (static_cast<std::size_t>(v) + side_ * static_cast<std::size_t>(w));
    }
    for (std::size_t d = 0; d < lowest_.size(); ++d) {
        for (std::size_t k = 0; k < 8; ++k) points[lowest_[d] + step[k]] = refined.cells[first + d][k];
    }
}

}  // namespace subvol::detail
