// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "subvol/mesh_source.h"

namespace subvol::detail {

/// Some of the owned cells of a part, as owned cells, with `layers` of cells about them.
///
/// part:   with as many layers about its owned cells
/// chosen: a flag for each cell
[[nodiscard]] MeshPiece chosen_cells(const MeshPiece& part, std::span<const std::uint8_t> chosen, int layers);

struct GatherOptions {
    std::function<bool(std::size_t)> reads;  ///< whether a piece may have cells that are wanted; the others are not read
    /// The owned cells of a piece that are wanted: a flag for each cell
    std::function<std::vector<std::uint8_t>(const MeshPiece&)> chooses;
    int layers;                                    ///< layers of cells around the chosen ones; not more than the pieces have
    std::uint64_t most_cells = ~std::uint64_t{0};  ///< the most cells that are gathered, with these layers
    Progress* progress = nullptr;
};

/// `chosen_cells` of all pieces, in the order of the whole mesh.
///
/// returns: nothing if there are more cells than `most_cells`
/// throws:  what reading throws; Error(Cancelled)
/// cost:    memory: the result twice, and one piece at a time
[[nodiscard]] std::optional<MeshPiece> gather_cells(const MeshSource::Stored& stored, const GatherOptions& options);

}  // namespace subvol::detail
