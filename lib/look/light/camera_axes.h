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

/// What is up in the picture of a view: the axis that is up, unless the view is along it.
inline Vec3 upright_for(const Vec3& direction, UpAxis up = UpAxis::Z) {
    const Vec3 axis = turned_upright(Vec3(0, 0, 1), up);
    const bool along = std::abs(glm::dot(glm::normalize(direction), axis)) > 0.999;
    return along ? turned_upright(Vec3(0, 1, 0), up) : axis;
}

}  // namespace subvol::detail
