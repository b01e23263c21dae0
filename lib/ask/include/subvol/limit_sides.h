// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/refine.h"
#include "subvol/shells.h"

namespace subvol {

/// Sides of cells where they lie in the limit of the whole mesh, on its boundary or between two cells: `limit_shells` of faces
/// that a mesh has. So what is drawn of a part of a mesh is a part of its limit, not the limit of the part alone.
///
/// whole:   the mesh that the sides are of, with their fields, by name
/// sides:   of `patch_shells`. Fields that the mesh does not have, such as "patch", keep the value of each side
/// returns: fields that are functions of others have the values of the function of the limit
/// throws:  Error(InvalidInput) as `limit_shells`, or if a point of the sides is not of the mesh
/// cost:    that of `limit_shells`; only cells near the sides are copied
[[nodiscard]] Shells limit_sides(const HexMesh& whole, const Shells& sides, const RefineOptions& options = {});

}  // namespace subvol
