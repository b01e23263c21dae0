// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/limit_level.h"

namespace subvol::detail {

/// The limit's pieces within cells.max_bytes: where they would be more, the tolerances are enlarged until they are not.
[[nodiscard]] LimitCells pieces_within(const HexMesh& mesh, const RefineOptions& refinement, LimitCellsOptions cells);

}  // namespace subvol::detail
