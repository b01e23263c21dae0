// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cell_request.h"

namespace subvol::detail {

/// In voxels, counter-clockwise from outside.
using VoxelTriangle = std::array<Vec3, 3>;

/// The boundary of what a request rasterizes, each quad cut as the rasterizer cuts it: it bounds the tetrahedra exactly.
///
/// Cells whose corners are in the opposite order of their neighbours' are turned round for this; of a part that hangs together
/// the whole may be turned inside out.
[[nodiscard]] std::vector<VoxelTriangle> boundary_triangles(const CellRequest& request);

}  // namespace subvol::detail
