// SPDX-License-Identifier: Apache-2.0
#include "local_system.h"

#include <cmath>

namespace subvol::detail {

Vec3 rectangular(Coordinates kind, const Vec3& at) {
    if (kind == Coordinates::Rectangular) return at;
    const Vec3 around(std::cos(at.y), std::sin(at.y), 0);
    if (kind == Coordinates::Cylindrical) return at.x * around + Vec3(0, 0, at.z);
    const double c = std::cos(at.z), s = std::sin(at.z);
    return kind == Coordinates::Spherical ? at.x * (c * around + Vec3(0, 0, s)) : at.x * (s * around + Vec3(0, 0, c));
}

std::array<Vec3, 3> axes_along(const Vec3& x, const Vec3& y) {
    const Vec3 first = x / glm::length(x), normal = glm::cross(first, y), third = normal / glm::length(normal);
    return {first, glm::cross(third, first), third};
}

}  // namespace subvol::detail
