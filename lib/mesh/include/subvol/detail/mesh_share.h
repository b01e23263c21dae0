// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "subvol/mesh_report.h"
#include "subvol/share.h"

namespace subvol::detail {

/// The figures of a share of a mesh, for several processes.
struct MeshShare {
    /// Numbers of the share's points, of the edges and faces whose smallest point is one of them, and of the share's cells;
    /// points, cells and bounds are those of the whole mesh, volume is not used
    MeshReport counts;
    ShareRange range{};  ///< range of the parts that the work is divided into
    /// Volumes of the share's cells, 4096 at a time, or of its bricks: adding these up in the order of the shares gives the
    /// bits of `inspect`
    std::vector<double> volumes{};
    std::vector<std::size_t> inverted{};  ///< the numbers of the first inverted cells, at most as many as were asked for
};

/// throws: as `inspect`
[[nodiscard]] MeshShare inspect_share(const MeshSource& source, const Share& share, std::size_t inverted_at_most,
                                      Progress* progress = nullptr);

/// The report of the whole mesh, as `inspect` makes it, and the first inverted cells.
///
/// shares: all, in their order
[[nodiscard]] MeshShare join_shares(std::span<const MeshShare> shares, std::size_t inverted_at_most);

/// `inspect` of a part of a mesh: counts what it owns. An edge or a face belongs to the owner of its smallest point.
///
/// part: with all cells at every point that it owns
void add_part(const HexMesh& part, std::span<const std::uint8_t> owned_points, std::span<const std::uint8_t> owned_cells,
              MeshReport& report);

}  // namespace subvol::detail
