// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "subvol/detail/gather_cells.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/mesh_source.h"

namespace subvol::detail {

/// For each cell of a mesh a box that its limit does not leave: that of the cell and those about it, and a quarter more. The
/// weights of interpolating schemes are partly negative, but their sum over absolute values is below 1.5.
class CellReaches {
public:
    explicit CellReaches(const HexMesh& mesh);
    [[nodiscard]] Box operator()(std::size_t cell) const;

private:
    const HexMesh& mesh_;
    std::vector<Box> about_;  // each point: the cells that have it
};

[[nodiscard]] bool touch(const Box& a, const Box& b);

/// Some cells of a part with their points, and the tags that belong to them.
[[nodiscard]] MeshPiece subset(const MeshPiece& part, std::span<const std::uint8_t> cells);

/// Parts of one mesh as one; what they have in common is in the result once, and owned if one of them owns it.
[[nodiscard]] MeshPiece merged(std::vector<MeshPiece> parts);

/// The points of owned cells that lie on the hull of the whole mesh. There must be a layer of halo at least.
[[nodiscard]] std::vector<std::uint8_t> hull_points_of_owned(const MeshPiece& part);

}  // namespace subvol::detail
