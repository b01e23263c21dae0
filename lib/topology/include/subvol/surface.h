// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// A triangle surface in world units; the boundary of a volume has its triangles counter-clockwise from outside.
struct Surface {
    std::vector<Vec3> points;
    std::vector<std::array<Index, 3>> triangles;
};

/// The boundary of a hexahedral mesh, two triangles a quad, split along the diagonal of the quad's smallest point id (as
/// `split_cell` does, so that the surface bounds the tetrahedra exactly).
[[nodiscard]] Surface boundary_surface(const HexMesh& mesh);

}  // namespace subvol
