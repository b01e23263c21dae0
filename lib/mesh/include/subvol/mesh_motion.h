// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/hex_mesh.h"

namespace subvol {

/// Whether two meshes have the same cells, creases and sharp faces: their refinements then differ only in points and values.
[[nodiscard]] bool same_cells(const HexMesh& a, const HexMesh& b);

/// Whether two meshes have the same cells between corresponding points. Their creases may differ: a body that is bent has other
/// sharp edges.
[[nodiscard]] bool moved_cells(const HexMesh& a, const HexMesh& b);

/// The mesh whose points and values are 1 − t of those of a mesh and t of those of another; all else is that of the first.
///
/// throws: Error(InvalidInput) if their cells, or the names and channels of their fields differ
[[nodiscard]] HexMesh mesh_between(HexMesh a, const HexMesh& b, double t);

/// The velocity of the points between two meshes with the same cells, as an attribute: their displacement divided by the time
/// between the meshes, in world units per unit of `time`. It is of second order in the middle of that time. As refinement is
/// linear, the refined attribute is the velocity of the refined points.
///
/// returns: three channels
/// throws:  Error(InvalidInput) if the cells differ or the time is not positive
[[nodiscard]] Attribute velocity_between(const HexMesh& before, const HexMesh& after, double time,
                                         const std::string& name = "vel");

}  // namespace subvol
