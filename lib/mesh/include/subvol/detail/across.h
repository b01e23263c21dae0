// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "subvol/vec.h"

namespace subvol::detail {

/// Two vectors across a direction, of unit length: with it a right-handed frame. along: of unit length
[[nodiscard]] inline std::array<Vec3, 2> across(const Vec3& along) {
    const Vec3 a = glm::abs(along);
    const Vec3 other = a.x <= a.y && a.x <= a.z ? Vec3(1, 0, 0) : a.y <= a.z ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
    const Vec3 u = glm::normalize(glm::cross(along, other));
    return {u, glm::cross(along, u)};
}

}  // namespace subvol::detail
