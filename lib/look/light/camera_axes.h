// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "subvol/camera.h"
#include "subvol/error.h"

namespace subvol::detail {

/// Validates a camera.
///
/// throws: Error(InvalidInput) if its numbers define no view
void validate(const Camera& camera);

inline void require(bool ok, const char* message, const char* allowed = "") {
    if (!ok) throw Error(ErrorCode::InvalidInput, message, "camera", allowed);
}

inline bool finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline double half_fov_tangent(double fovy_deg) {
    return std::tan(0.5 * fovy_deg * std::numbers::pi / 180);
}

/// Right, up, forward.
inline std::array<Vec3, 3> camera_axes(const Vec3& forward_any_length, const Vec3& up) {
    const Vec3 forward = glm::normalize(forward_any_length);
    const Vec3 right = glm::normalize(glm::cross(forward, glm::normalize(up)));
    return {right, glm::cross(right, forward), forward};
}

inline Vec3 upright_for(const Vec3& direction) {
    const Vec3 d = glm::normalize(direction);
    return std::abs(d.z) > 0.999 ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
}

}  // namespace subvol::detail
