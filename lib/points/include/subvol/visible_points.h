// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/rbf_volume.h"
#include "subvol/transfer_function.h"

namespace subvol {

/// What is left of a volume without the points that a transfer function makes invisible.
struct VisibleVolume {
    RbfVolume volume;
    std::size_t dropped = 0;
};

/// Drops the points whose whole support is invisible: wherever such a kernel reaches, whatever the field may be there has no
/// opacity. In a small box the field may be anything between the least and the largest corrected value that kernels have there:
/// it is their mean. So what is dropped changes nothing that is seen.
///
/// function: of the channel's values; only its opacity counts. `opaque_above(t)` hides what is at or below t.
/// throws:   Error(InvalidInput) if there is no such channel, the function is not valid, or the kernel has negative lobes:
/// their
///           field is not bounded by the kernels' values
/// cost:     O(n) in time; memory of a grid with about eight boxes a point
[[nodiscard]] VisibleVolume drop_invisible(const RbfVolume& volume, std::size_t channel, const TransferFunction& function);

/// A white transfer function that is opaque above a value, and clear at it and below.
[[nodiscard]] TransferFunction opaque_above(double value);

}  // namespace subvol
