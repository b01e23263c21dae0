// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "distortion.h"

namespace subvol::detail {

/// The sum of (1 − s / s₀)² over those corners of a cell whose scaled Jacobian s, the determinant of the unit vectors along
/// their edges, is below s₀.
///
/// least:  s₀
/// slopes: by each coordinate
///
/// source: [tong2024]
[[nodiscard]] double flatness_of(const CornerCoordinates& corners, double least, CornerCoordinates& slopes);

}  // namespace subvol::detail
