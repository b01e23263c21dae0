// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh_file.h"

namespace subvol::detail {

/// Makes cells that use points at the same place use the first of these; says how many points that were.
///
/// tolerance: a point is joined to the first one before it that is no farther away; world units, 0: at exactly the same place
/// throws:    Error(InvalidInput) if a cell would have a corner twice
/// cost:      O(n), if not many points lie within a tolerance
void weld_points(MeshFile& found, double tolerance, std::string_view file, const Wording& wording);

}  // namespace subvol::detail
