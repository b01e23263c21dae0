// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "subvol/topology.h"

namespace subvol::detail {

/// A structured grid that a mesh is: its cells, u fastest, and how each lies.
///
/// corners: for each corner of a cell in the grid's orientation, the corner as the mesh has it
struct StructuredCells {
    std::array<std::size_t, 3> counts{};
    std::vector<Index> cells;
    std::vector<std::array<std::uint8_t, 8>> corners;
};

/// Nothing if the mesh is not one block of nx × ny × nz cells.
[[nodiscard]] std::optional<StructuredCells> structured_cells(const Topology& topology);

}  // namespace subvol::detail
