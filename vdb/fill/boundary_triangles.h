// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "cell_request.h"

namespace subvol::detail {

/// In voxels, counter-clockwise seen from outside.
using VoxelTriangle = std::array<Vec3, 3>;

/// The boundary of the cells of a request. Quads are cut into triangles as the rasterizer cuts them, so the triangles bound its
/// tetrahedra exactly.
///
/// Triangles of a connected part are oriented consistently, even if some of its cells have the opposite corner order; but a
/// whole part may be inside out.
///
/// wanted: whether the sides of a cell are asked for; none: those of all cells
[[nodiscard]] std::vector<VoxelTriangle> boundary_triangles(const CellRequest& request,
                                                            const std::function<bool(Index cell)>& wanted = {});

}  // namespace subvol::detail
