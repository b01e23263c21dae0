// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/vdb_grid.h"

namespace subvol::detail {

/// Another object for the same grid: the voxels are shared, the report is copied. For those who need grids side by side that
/// lie elsewhere, and that others use meanwhile.
[[nodiscard]] VdbGrid shared_grid(const VdbGrid& grid);

}  // namespace subvol::detail
