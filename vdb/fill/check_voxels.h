// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "cell_request.h"
#include "voxel_bricks.h"

namespace subvol::detail {

/// numbers: those of a request
/// returns: the signed volume in voxels; negative if the cells are left-handed in voxel space
/// throws:  Error(InvalidInput) if the mesh reaches 2³⁰ voxels from their origin or would fill more than 2·10⁹
double check_voxel_count(const HexMesh& mesh, const ToVoxels& to_voxels, std::span<const Index> numbers);

/// throws: Error(InvalidInput) if the boxes touch more than 5·10⁷ bricks, counted with repetition
void check_brick_count(std::span<const VoxelBox> boxes, double voxel_size);

}  // namespace subvol::detail
