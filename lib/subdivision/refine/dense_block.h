// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// The vertices of one control cell's descendants as a grid.
class DenseBlock {
public:
    explicit DenseBlock(int levels);

    [[nodiscard]] std::size_t side() const { return side_; }
    [[nodiscard]] std::size_t node_count() const { return side_ * side_ * side_; }

    /// The points of the grid's nodes (u fastest) in a mesh whose cells [first, first + 8^levels) descend from the cell.
    void nodes(const HexMesh& refined, std::size_t first, std::vector<Index>& points) const;

private:
    std::size_t side_;
    std::vector<std::uint32_t> lowest_;  // for each descendant: the node at its lowest corner
};

}  // namespace subvol::detail
