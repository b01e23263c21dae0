// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "point_lines.h"
#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// Fills in the Hessians of all channels from the gradients that the volume has, by least squares over the neighbours on the
/// lines: along a line from the values, across it from the differences of the gradients.
void fit_hessians(const PointLines& lines, RbfVolume& volume);

}  // namespace subvol::detail
