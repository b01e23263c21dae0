// SPDX-License-Identifier: Apache-2.0
#include "camera_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace subvol::detail {

namespace {

constexpr double kSteepest_deg = 89.9;  // beyond it up would be parallel to the view

double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

double height_at_target(const Camera& camera) {
    if (camera.ortho_height > 0) return camera.ortho_height;
    return 2 * std::tan(radians(camera.fovy_deg) / 2) * glm::distance(camera.eye, camera.target);
}

}  // namespace

Vec3 turned(const Vec3& v, const Vec3& axis, double angle_deg) {
    const double angle = radians(angle_deg);
    return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) + axis * glm::dot(axis, v) * (1 - std::cos(angle));
}

Camera orbited(Camera camera, double right_deg, double up_deg) {
    const Vec3 axis = glm::normalize(camera.up);
    Vec3 arm = turned(camera.eye - camera.target, axis, right_deg);
    const double height = std::clamp(glm::dot(arm, axis) / glm::length(arm), -1.0, 1.0);
    const double elevation_deg = std::asin(height) * 180 / std::numbers::pi;
    const double wanted_deg = std::clamp(elevation_deg + up_deg, -kSteepest_deg, kSteepest_deg);
    const Vec3 right = glm::normalize(glm::cross(axis, arm));
    arm = turned(arm, right, elevation_deg - wanted_deg);
    camera.eye = camera.target + arm;
    return camera;
}

Camera panned(Camera camera, double right, double up) {
    const double height = height_at_target(camera);
    const Vec3 forward = glm::normalize(camera.target - camera.eye);
    const Vec3 to_right = glm::normalize(glm::cross(forward, camera.up)), to_top = glm::cross(to_right, forward);
    return aimed(camera, camera.target - height * (right * to_right + up * to_top));
}

Camera aimed(Camera camera, const Vec3& place) {
    camera.eye += place - camera.target;
    camera.target = place;
    return camera;
}

Camera zoomed(Camera camera, double factor, const Vec2& about) {
    const double stays = 1 - 1 / factor;  // the part of the way to the place that the target goes
    camera = panned(camera, -stays * about.x, -stays * about.y);
    camera.eye = camera.target + (camera.eye - camera.target) / factor;
    camera.ortho_height /= factor;
    return camera;
}

Camera with_parallel_rays(Camera camera, bool parallel) {
    if (parallel == (camera.ortho_height > 0)) return camera;
    if (parallel) {
        camera.ortho_height = height_at_target(camera);
        return camera;
    }
    const double distance = camera.ortho_height / (2 * std::tan(radians(camera.fovy_deg) / 2));
    camera.eye = camera.target + distance * glm::normalize(camera.eye - camera.target);
    camera.ortho_height = 0;
    return camera;
}

}  // namespace subvol::detail
