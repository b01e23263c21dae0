// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "subvol/bricks.h"
#include "subvol/detail/limit_of_part.h"

namespace subvol::detail {

/// throws: Error(InvalidInput) if the bricks have fewer layers of halo
void check_halo_of_limit(const Bricks& bricks);

/// Some of the owned cells of a part, as owned cells, with `layers` of cells about them.
///
/// part:   with as many layers about its owned cells
/// chosen: a flag for each cell
[[nodiscard]] BrickMesh chosen_cells(const BrickMesh& part, std::span<const std::uint8_t> chosen, int layers);

/// reads:      whether a brick may have cells that are wanted; the others are not read
/// chooses:    the owned cells of a brick that are wanted: a flag for each cell
/// layers:     of cells about those; not more than the bricks have
/// most_cells: that are gathered, with these layers
/// fields:     changes the attributes of each brick; none: they stay
struct GatherOptions {
    std::function<bool(std::size_t)> reads;
    std::function<std::vector<std::uint8_t>(const BrickMesh&)> chooses;
    int layers = kHaloOfLimit;
    std::uint64_t most_cells = ~std::uint64_t{0};
    BrickFields fields{};
    Progress* progress = nullptr;
};

/// `chosen_cells` of all bricks, in the order of the whole mesh.
///
/// returns: nothing if there are more cells than `most_cells`
/// throws:  as `read_brick`; Error(Cancelled)
/// cost:    memory: the result twice, and one brick at a time
[[nodiscard]] std::optional<BrickMesh> gather_cells(const Bricks& bricks, const GatherOptions& options);

}  // namespace subvol::detail
