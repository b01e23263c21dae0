// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "camera_axes.h"
#include "subvol/camera_fit.h"

namespace subvol {

using namespace detail;
namespace {

constexpr double kMargin = 1.05;  // the box takes at most 1/1.05 of the picture

/// A rotation about the axis through a centre along a unit vector.
class Turn {
public:
    Turn(const Vec3& axis, const Vec3& center, double angle)
        : axis_(axis), center_(center), cos_(std::cos(angle)), sin_(std::sin(angle)) {}

    [[nodiscard]] Vec3 operator()(const Vec3& point) const {
        const Vec3 d = point - center_, along = glm::dot(axis_, d) * axis_;
        return center_ + along + cos_ * (d - along) + sin_ * glm::cross(axis_, d);
    }

private:
    Vec3 axis_, center_;
    double cos_, sin_;
};

Turn frame_turn(const Camera& camera, const Vec3& center, int frame, int frames) {
    return {glm::normalize(camera.up), center, 2 * std::numbers::pi * frame / frames};
}

std::vector<Vec3> corners_of(const Box& box) {
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) {
        corners.push_back(box.center() + 0.5 * box.size() * Vec3((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1));
    }
    return corners;
}

void require_box(const Box& box) {
    require(!box.empty(), "there is no box to look at");
    require(std::isfinite(box.diagonal()), "the box to look at is too large: the squares of its sides are infinite",
            "coordinates up to 1e150");
}

/// Fits a camera to points around the box's centre whose distance from it is at most that of the box's corners.
Camera fit(const Camera& camera, std::span<const Vec3> points, const Box& box, double aspect) {
    validate(camera);
    require_box(box);
    require(std::isfinite(aspect) && aspect > 0, "the picture's aspect is not a positive number");
    const auto axes = camera_axes(camera.target - camera.eye, camera.up);
    const bool perspective = camera.ortho_height == 0;
    const double tan_y = perspective ? half_fov_tangent(camera.fovy_deg) : 1;
    const Vec3 middle = camera.eye + glm::dot(axes[2], box.center() - camera.eye) * axes[2];
    double distance = 0, half_height = 0;  // of the eye from the middle, and of the picture: every point must fit
    for (const Vec3& point : points) {
        const Vec3 d = point - middle;
        const double across = std::max(std::abs(glm::dot(axes[0], d)) / aspect, std::abs(glm::dot(axes[1], d)));
        half_height = std::max(half_height, kMargin * across);
        if (perspective) distance = std::max(distance, kMargin * across / tan_y - glm::dot(axes[2], d));
    }
    // A box without extent across the view still needs an eye outside it, and a picture.
    distance = std::max(distance, box.diagonal() > 0 ? 0.55 * box.diagonal() : 1.0);
    if (!(half_height > 0)) half_height = distance;
    return {.eye = middle - distance * axes[2],
            .target = middle,
            .up = camera.up,
            .fovy_deg = camera.fovy_deg,
            .ortho_height = perspective ? 0 : 2 * half_height};
}

}  // namespace

Vec3 turned_upright(const Vec3& v, UpAxis up) {
    if (up == UpAxis::X) return {v.z, v.y, -v.x};
    if (up == UpAxis::Y) return {v.x, v.z, -v.y};
    return v;
}

Camera fit_camera(const Box& box, const Vec3& direction, double fovy_deg, double aspect, UpAxis up) {
    require(finite(direction) && direction != Vec3(0.0), "the direction of view is zero or not finite");
    require_box(box);
    const Vec3 back = std::max(box.diagonal(), 1.0) * glm::normalize(direction);
    return fit_camera(
        {.eye = box.center() - back, .target = box.center(), .up = upright_for(direction, up), .fovy_deg = fovy_deg}, box,
        aspect);
}

Camera fit_camera(const Camera& camera, const Box& box, double aspect) {
    return fit(camera, corners_of(box), box, aspect);
}

Camera fit_camera_to_points(const Camera& camera, std::span<const Vec3> points, double aspect) {
    validate(camera);
    Box box;
    for (const Vec3& point : points) box.add(point);
    require_box(box);
    const auto axes = camera_axes(camera.target - camera.eye, camera.up);
    // The middle of the outline moves as the eye moves: a few steps suffice.
    constexpr int kSteps = 4;
    Camera fitted = fit(camera, points, box, aspect);
    for (int step = 0; step < kSteps; ++step) {
        Vec2 low(std::numeric_limits<double>::infinity()), high(-low);
        // The depth of the box's centre, so that points inside the outline change nothing: parts of a mesh may lack them.
        const double depth = glm::dot(axes[2], box.center() - fitted.eye);
        for (const Vec3& point : points) {
            const Vec3 d = point - fitted.eye;
            const double z = glm::dot(axes[2], d), scale = camera.ortho_height == 0 ? 1 / std::max(z, 1e-300) : 1;
            const Vec2 seen = scale * Vec2(glm::dot(axes[0], d), glm::dot(axes[1], d));
            low = glm::min(low, seen);
            high = glm::max(high, seen);
        }
        const Vec2 off = (camera.ortho_height == 0 ? depth : 1) * 0.5 * (low + high);
        Camera moved = fitted;
        moved.eye += off.x * axes[0] + off.y * axes[1];
        moved.target += off.x * axes[0] + off.y * axes[1];
        fitted = fit(moved, points, box, aspect);
    }
    return fitted;
}

Camera orthographic_camera(const Camera& camera, const Box& box, double aspect) {
    Camera orthographic = camera;
    orthographic.ortho_height = 1;
    return fit_camera(orthographic, box, aspect);
}

std::vector<Camera> turntable(const Camera& camera, const Vec3& center, int frames) {
    constexpr int kMaxFrames = 100000;
    validate(camera);
    require(frames >= 1 && frames <= kMaxFrames, "the number of frames is out of range", "1..100000");
    std::vector<Camera> cameras(static_cast<std::size_t>(frames), camera);
    for (int i = 1; i < frames; ++i) {
        const Turn turn = frame_turn(camera, center, i, frames);
        cameras[static_cast<std::size_t>(i)].eye = turn(camera.eye);
        cameras[static_cast<std::size_t>(i)].target = turn(camera.target);
    }
    return cameras;
}

Camera fit_turntable(const Camera& camera, const Box& box, int frames, double aspect) {
    validate(camera);
    require(frames >= 1, "the number of frames is out of range", "1 or more");
    // To turn the camera one way is to turn the box the other way.
    std::vector<Vec3> points;
    for (int i = 0; i < frames; ++i) {
        const Turn turn = frame_turn(camera, box.center(), -i, frames);
        for (const Vec3& corner : corners_of(box)) points.push_back(turn(corner));
    }
    return fit(camera, points, box, aspect);
}

}  // namespace subvol
