// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/vdb_grid.h"

namespace subvol {

/// Extends a grid of vectors by `layers` voxels in all directions. Layer by layer, each new voxel gets the mean of its active
/// neighbours from the layers before.
///
/// Renderers with motion blur read the velocity where the volume may have been while the shutter was open, which is outside it.
///
/// layers: 0 to 1000
/// throws: Error(InvalidInput) if the voxels are not vectors of floats, or layers is out of range
/// cost:   some 2 µs of one core per new voxel, parallel; the same for any number of threads. Memory: the new grid and its mask
[[nodiscard]] VdbGrid spread_vectors(const VdbGrid& grid, int layers);

}  // namespace subvol
