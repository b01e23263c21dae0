// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "subvol/vec.h"

namespace subvol::detail {

/// How three coordinates of a file name a point: x, y, z; a radius, an angle from x about z, and z; or a radius, an angle from
/// x about z, and a second angle.
///
/// Spherical: the second angle is that above the plane of x and y
/// Polar:     it is that from the z axis
enum class Coordinates { Rectangular, Cylindrical, Spherical, Polar };

/// The point's x, y and z. at: angles in radians
[[nodiscard]] Vec3 rectangular(Coordinates kind, const Vec3& at);

/// A system of axes, at right angles and of length 1, that coordinates of a file refer to.
struct LocalSystem {
    Vec3 origin{0.0};
    std::array<Vec3, 3> axes{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};

    [[nodiscard]] Vec3 operator()(const Vec3& x) const { return origin + x.x * axes[0] + x.y * axes[1] + x.z * axes[2]; }
};

/// The axes whose first one points along `x`, and whose second one lies on the side of `y`. Not finite if these are parallel
/// or have no length.
[[nodiscard]] std::array<Vec3, 3> axes_along(const Vec3& x, const Vec3& y);

}  // namespace subvol::detail
