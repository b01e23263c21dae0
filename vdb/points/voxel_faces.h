// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "subvol/boundary_values.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// The faces between active and inactive voxels of a tree without tiles, closed and outward, two triangles each, with the mean
/// of the active voxels about each corner.
///
/// to_world, origin: the centre of voxel ijk is to_world · ijk + origin
/// throws: Error(InvalidInput) if there are more corners than indices
/// cost:   200 bytes a face, one core
[[nodiscard]] BoundaryValues voxel_faces(const openvdb::FloatTree& tree, const Mat3& to_world, const Vec3& origin);

}  // namespace subvol::detail
