// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/rbf_volume.h"
#include "subvol/transfer_function.h"

namespace subvol {

/// A volume without the points that a transfer function makes invisible.
struct VisibleVolume {
    RbfVolume volume;
    std::size_t dropped = 0;
};

/// Drops the points whose whole support is invisible: no value that the field can have there has any opacity. The field is a
/// weighted mean of the kernels' corrected values, so in a small box it lies between the least and the largest of them.
/// Pictures do not change.
///
/// function: of the channel's values; only its opacity counts. `opaque_above(t)` hides what is at or below t.
/// throws:   Error(InvalidInput) if there is no such channel, the function is not valid, or the kernel has negative lobes: then
///           the field is not bounded by the kernels' values
/// cost:     O(n) time; memory of a grid with about eight boxes per point
[[nodiscard]] VisibleVolume drop_invisible(const RbfVolume& volume, std::size_t channel, const TransferFunction& function);

/// A white transfer function that is opaque above a value, and clear at it and below.
[[nodiscard]] TransferFunction opaque_above(double value);

}  // namespace subvol
