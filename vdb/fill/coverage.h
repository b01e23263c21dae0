// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cell_request.h"
#include "voxel_bricks.h"

namespace subvol::detail {

inline constexpr int kCoverageSamples = 4;  // along each axis of a voxel: a brick of samples is a leaf of voxels

/// A request whose voxels are the samples of the given request's voxels, without values.
[[nodiscard]] CellRequest samples_within(CellRequest request);

/// The part of each voxel that is covered: one channel, active where it is above zero.
[[nodiscard]] VoxelBricks coverage_of(VoxelBricks samples);

}  // namespace subvol::detail
