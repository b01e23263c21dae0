// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/vdb_grid.h"

namespace subvol {

/// A grid of vectors that reaches so many voxels further, to all sides: layer by layer, each new voxel has the mean of the
/// voxels about it that were there before.
///
/// Renderers that blur what moves ask for the velocity where the volume may have been, which is outside it.
/// layers: 0 to 1000
/// throws: Error(InvalidInput) if the voxels are no vectors of floats, or of so many layers
/// cost:   some 2 µs of one core a new voxel, parallel; the same for any number of threads. Memory: the new grid and its mask
[[nodiscard]] VdbGrid spread_vectors(const VdbGrid& grid, int layers);

}  // namespace subvol
