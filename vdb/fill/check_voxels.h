// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "cell_request.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// returns: the volume in voxels; negative if the cells are left-handed there
/// throws:  Error(InvalidInput) if the mesh reaches 2³⁰ voxels from their origin or would fill more than 2·10⁹
double check_voxel_count(const HexMesh& mesh, const ToVoxels& to_voxels);

/// throws: Error(InvalidInput) if the boxes touch so many bricks that there would be no end of it
void check_brick_count(std::span<const VoxelBox> boxes, double voxel_size);

}  // namespace subvol::detail
