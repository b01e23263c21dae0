// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/hex_mesh.h"

namespace subvol {

/// Whether cells, creases and sharp faces are the same: nothing of a refinement differs but points and values.
[[nodiscard]] bool same_cells(const HexMesh& a, const HexMesh& b);

/// How the points move from one mesh to another of the same cells: their differences over the time between the two, world units
/// a unit of `time`. At the middle of that time this is of second order. As refinement is linear, the refined attribute is the
/// velocity of the refined points.
///
/// returns: three channels
/// throws:  Error(InvalidInput) if the cells differ or the time is not positive
[[nodiscard]] Attribute velocity_between(const HexMesh& before, const HexMesh& after, double time,
                                         const std::string& name = "vel");

}  // namespace subvol
