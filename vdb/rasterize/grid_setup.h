// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "openvdb_grids.h"

#include "cell_request.h"
#include "subvol/rasterize.h"

namespace subvol::detail {

/// The transform to the voxels that the options describe. box: of what is rasterized, world
///
/// throws: Error(InvalidInput) if the size or the resolution is not positive, or the transform of `like` not linear
[[nodiscard]] ToVoxels to_voxels_of(const Box& box, const RasterizeOptions& options);

/// throws: Error(InvalidInput) if the voxels are too small for OpenVDB
void check_representable(double voxel_size);

/// throws: Error(InvalidInput) if the half width is out of range, or the voxels are not cubes
void check_level_set(const RasterizeOptions& options);

/// Sets a grid's transform, metadata and storage of floats.
///
/// frame: if the options have none
void describe(openvdb::GridBase& grid, const ToVoxels& to_voxels, const RasterizeOptions& options, const Box& frame);

/// A grid of bits named "mask": the active voxels of a grid of floats or vectors.
[[nodiscard]] openvdb::MaskGrid::Ptr mask_of(const openvdb::GridBase& grid);

}  // namespace subvol::detail
