// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "subvol/label_grid.h"
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

/// The labels of a grid of integers; voxels that are not active are outside.
///
/// throws: Error(InvalidInput) if the voxels are not integers, if a label is not from 0 to 2^31−1, if the transform is not
///         linear or singular, or if there are more than 2^31 voxels with labels
/// cost:   O(leaves and active tiles)
[[nodiscard]] LabelGrid labels_of_grid(const VdbGrid& grid);

}  // namespace subvol
