// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// A surface of triangles in world units; those of the boundary of a volume are counter-clockwise seen from outside.
struct Surface {
    std::vector<Vec3> points;
    std::vector<std::array<Index, 3>> triangles;
};

/// The box of the points that triangles use.
[[nodiscard]] Box bounds(const Surface& surface);

/// The volume that a closed surface encloses, with the sign of its orientation: positive if its triangles are counter-clockwise
/// seen from outside. Of an open one it depends on the order of the points.
[[nodiscard]] double enclosed_volume(const Surface& closed);

/// The boundary of a hexahedral mesh. Each quad gives two triangles, split along the diagonal from its smallest point id as in
/// `split_cell`, so that the surface is exactly the boundary of the tetrahedra.
[[nodiscard]] Surface boundary_surface(const HexMesh& mesh);

}  // namespace subvol
