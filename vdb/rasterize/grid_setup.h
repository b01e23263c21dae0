// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>

#include "cell_request.h"
#include "subvol/rasterize.h"

namespace subvol::detail {

/// The voxels that options ask for. box: of what is rasterized, world
///
/// throws: Error(InvalidInput) if the size or the resolution is not positive, or the transform of `like` not linear
[[nodiscard]] ToVoxels voxels_asked_for(const Box& box, const RasterizeOptions& options);

/// throws: Error(InvalidInput) if voxels are too small for OpenVDB
void check_representable(double voxel_size);

/// throws: Error(InvalidInput) if the half width is out of range, or the voxels are no cubes
void check_level_set(const RasterizeOptions& options);

/// Gives a grid its transform, metadata and the way its floats are stored.
void describe(openvdb::GridBase& grid, const ToVoxels& to_voxels, const RasterizeOptions& options);

/// A grid of bits named "mask": where a grid of floats or vectors is active.
[[nodiscard]] openvdb::MaskGrid::Ptr mask_of(const openvdb::GridBase& grid);

}  // namespace subvol::detail
