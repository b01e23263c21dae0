// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/scheme.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// throws: Error(InvalidInput) unless levels is 0 to 10
void check_levels(int levels);

/// What every use of a scheme starts from: the mesh, checked, without its unused points, with the creases that
/// scheme.crease_angle_deg finds.
///
/// levels: how many the mesh will be refined; level 0 needs no creases
/// throws: Error(InvalidInput) as `check_levels`, `validate` and `tag_creases`
[[nodiscard]] HexMesh control_mesh(HexMesh mesh, const SchemeOptions& scheme, int levels = 1);

}  // namespace subvol::detail
