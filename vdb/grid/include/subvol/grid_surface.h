// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "subvol/surface.h"
#include "subvol/vdb_grid.h"

namespace subvol {

/// The closed surface where a grid of floats has a value: between fog and its surroundings, or at the distance 0 of a level
/// set.
///
/// value:  without one 0 for a level set, and half of the greatest value for fog
/// returns: triangles, of which either side may be outside
/// throws: Error(InvalidInput) if the voxels are not floats, or the grid has the value nowhere; names its range
/// source: OpenVDB's volumeToMesh
[[nodiscard]] Surface grid_surface(const VdbGrid& grid, std::optional<double> value = {});

}  // namespace subvol
