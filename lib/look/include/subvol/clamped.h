// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/transfer_function.h"

namespace subvol {

/// The function that shows values beyond [min, max] as its nearer end: min and max become its first and last knots, of colours
/// and of opacities. Interpolating schemes overshoot between their control points; a map over more than the field's range would
/// show that.
///
/// throws: Error(InvalidInput) if the range is not finite or min > max, or as validate(function)
[[nodiscard]] TransferFunction clamped(const TransferFunction& function, double min, double max);

}  // namespace subvol
