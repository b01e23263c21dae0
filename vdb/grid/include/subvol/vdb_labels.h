// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/label_grid.h"
#include "subvol/vdb_grid.h"

namespace subvol {

/// The labels of a grid of integers; voxels that are not active are outside.
///
/// throws: Error(InvalidInput) if the voxels are not integers, if a label is not from 0 to 2^31−1, if the transform is not
///         linear or singular, or if there are more than 2^31 voxels with labels
/// cost:   O(leaves and active tiles)
[[nodiscard]] LabelGrid labels_of_grid(const VdbGrid& grid);

}  // namespace subvol
