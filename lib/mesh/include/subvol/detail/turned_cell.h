// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "subvol/topology.h"

namespace subvol::detail {

/// A cell with its corners in the order of the parameters of another cell: corner u + 2v + 4w.
struct TurnedCell {
    Index cell = 0;
    std::array<Index, 8> corners;
};

/// The cell with its own parameters.
[[nodiscard]] TurnedCell as_it_is(const Topology& topology, Index cell);

/// The cell beyond a side (0 low, 1 high) along an axis, turned in the same way; nothing beyond the hull.
[[nodiscard]] std::optional<TurnedCell> cell_beyond(const Topology& topology, const TurnedCell& from, std::size_t axis,
                                                    std::size_t side);

}  // namespace subvol::detail
