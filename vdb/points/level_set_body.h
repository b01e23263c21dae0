// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/kernel.h"
#include "subvol/rbf_volume.h"
#include "subvol/vdb_grid.h"

namespace subvol::detail {

struct LevelSetBody {
    RbfVolume volume;
    int voxels_a_side = 1;  ///< side of the blocks with a kernel in their middle, in voxels
};

/// The body within the surface of a level set, of density 1. It ends at the surface, where the distance is 0; kernels lie in
/// the middle of all blocks of voxels that reach inside.
///
/// voxels_a_side: of a block; 0: so many that there are up to 64 blocks along the longest side. More are taken where there
/// would
///                be more than 256
/// throws:        Error(InvalidInput) if there is no surface
/// cost:          O(blocks in the box of the surface + active voxels)
[[nodiscard]] LevelSetBody body_of_level_set(const VdbGrid& grid, int voxels_a_side, const Kernel& kernel);

}  // namespace subvol::detail
