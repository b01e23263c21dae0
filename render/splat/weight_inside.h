// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// What the kernels' weights add up to inside the volume: the median over the places of (some of) the kernels.
[[nodiscard]] double weight_inside(const RbfVolume& volume);

}  // namespace subvol::detail
