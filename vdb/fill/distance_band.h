// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "boundary_triangles.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// Distances of voxel centres from the nearest triangle, in voxels: one channel, active where they are below `half_width`.
/// Exact up to the rounding of a float.
///
/// part: only these voxels, whole bricks; none: all voxels
/// cost: some 10 ns of one core for each voxel of each triangle's box, grown by the half width; parallel over bricks, the same
///       result for any number of threads
[[nodiscard]] VoxelBricks distance_band(std::span<const VoxelTriangle> triangles, double half_width,
                                        const std::optional<VoxelBox>& part);

/// throws: Error(InvalidInput) if the band would hold more than 2·10⁹ voxels
void check_band(std::span<const VoxelTriangle> triangles, double half_width);

}  // namespace subvol::detail
