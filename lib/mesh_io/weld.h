// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh_file.h"

namespace subvol::detail {

/// Joins points at the same place: cells then use the first of them. Adds a warning that counts the points.
///
/// tolerance: a point is joined to the first one before it that is no farther away; world units, 0: at exactly the same place
/// throws:    Error(InvalidInput) if a cell would then have the same corner twice
/// cost:      O(n) if few points lie within a tolerance of each other
void weld_points(MeshFile& found, double tolerance, std::string_view file, const EntityNames& names);

}  // namespace subvol::detail
