// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "subvol/detail/spill_file.h"

namespace subvol::detail {

/// The cells of all bricks with their halos.
struct BrickCells {
    std::vector<std::uint32_t> owners;  ///< brick of the first cell of each point, 4 bytes a point
    std::vector<std::size_t> first;
    std::vector<Index> owned;  ///< the cells of brick b are owned[first[b] .. first[b + 1]), ascending. 4 bytes a cell
    std::vector<std::pair<std::uint32_t, Index>> halo;  ///< brick and cell, ascending. 8 bytes each

    /// The cells of a brick with its halo, ascending.
    [[nodiscard]] std::vector<Index> stored(std::size_t brick) const;
    [[nodiscard]] std::span<const Index> owned_by(std::size_t brick) const;
};

/// Finds the halos of all bricks at once: reads the corners of the cells `layers` + 2 times from their beginning to their end.
///
/// corners: eight Indices for each cell. bricks: of the cells
[[nodiscard]] BrickCells cells_of_bricks(const SpillFile& corners, std::size_t points, std::vector<std::uint32_t> bricks,
                                         int layers);

}  // namespace subvol::detail
