// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// The ellipsoid (x−μ)ᵀ S⁻¹ (x−μ) = 1 of a frame.
struct PrincipalAxes {
    Vec3 half_axes{1.0};   ///< world, longest first; at least 10⁻⁶ of the longest, however flat the frame is
    Mat3 directions{1.0};  ///< unit columns, right-handed
};

/// frame: as in RbfVolume
[[nodiscard]] PrincipalAxes principal_axes(const Symmetric3& frame);

/// A rotation as a unit quaternion w x y z, w not negative.
[[nodiscard]] std::array<double, 4> quaternion(const Mat3& rotation);

}  // namespace subvol::detail
