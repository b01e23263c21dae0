// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace subvol::detail {

/// x, y and z of the eight corners of a cell, in VTK's order.
using CornerCoordinates = std::array<std::array<double, 8>, 3>;

/// The sum of the distortions of a cell's corners. A corner with its edges as the columns of J, whose determinant is D, has
///
///     |J|² / χ^⅔ + ½ (D² + 1) / χ,      χ = (D + √(ε² + D²)) / 2
///
/// which is least for the corner of a cube with the side 1 and, where ε is 0, infinite where D is not positive. With ε it is
/// finite there and draws D upwards.
///
/// slopes: by each coordinate
[[nodiscard]] double distortion_of(const CornerCoordinates& corners, double epsilon, CornerCoordinates& slopes);

}  // namespace subvol::detail
