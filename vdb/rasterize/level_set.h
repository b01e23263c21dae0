// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "openvdb_grids.h"

#include "voxel_bricks.h"

namespace subvol::detail {

/// Turns distances into a level set: in world units, negative where the mask is active, ± the half width beyond the band.
///
/// band: distances in voxels, as `distance_band` makes them
[[nodiscard]] openvdb::FloatGrid::Ptr level_set(VoxelBricks band, const openvdb::MaskGrid& inside, double voxel_size,
                                                double half_width_voxels);

}  // namespace subvol::detail
