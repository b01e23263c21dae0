// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "sheets.h"
#include "subvol/refine.h"

namespace subvol::detail {

/// A finer mesh of the same shape: sheets are split where cells ask for it (`edges_to_split`), and its limit is that of the
/// mesh at all of its corners (`graded_places`). Where all sheets are split it is `refine`, and the limit the same everywhere.
///
/// mesh:    with the fields that decide across which directions; cells: a flag for each, whether it asks
/// options: new corners lie on the limit as it is interpolated between its points on level `levels`
[[nodiscard]] SplitMesh refine_where(const HexMesh& mesh, std::span<const std::uint8_t> cells, const RefineOptions& options);

}  // namespace subvol::detail
