// SPDX-License-Identifier: Apache-2.0
#include "model_shapes.h"

#include <algorithm>
#include <cmath>

namespace subvol::model {
namespace {

/// The part of q across an axis.
Vec2 across(const Vec3& q, int axis) {
    return {q[(axis + 1) % 3], q[(axis + 2) % 3]};
}

}  // namespace

double ball(const Vec3& q, double radius) {
    return radius - glm::length(q);
}

double ellipsoid(const Vec3& q, const Vec3& radii) {
    // Source: I. Quilez, "Distance functions": 1 - |q/r| by its slope. At the centre both lengths are 0.
    const double k = glm::length(q / radii), slope = glm::length(q / (radii * radii));
    return slope > 0 ? k * (1 - k) / slope : std::min({radii.x, radii.y, radii.z});
}

double box(const Vec3& q, const Vec3& half, double rounding) {
    const Vec3 d = glm::abs(q) - half + rounding;
    return rounding - glm::length(glm::max(d, 0.0)) - std::min(std::max({d.x, d.y, d.z}), 0.0);
}

double cylinder(const Vec3& q, int axis, double radius, double half, double rounding) {
    const Vec2 d = Vec2(glm::length(across(q, axis)) - radius, std::abs(q[axis]) - half) + rounding;
    return rounding - glm::length(glm::max(d, 0.0)) - std::min(std::max(d.x, d.y), 0.0);
}

double ring(const Vec3& q, int axis, double radius, double tube) {
    return tube - std::hypot(glm::length(across(q, axis)) - radius, q[axis]);
}

double rod(const Vec3& q, const Vec3& a, const Vec3& b, double radius_a, double radius_b) {
    const Vec3 along = b - a;
    const double t = std::clamp(glm::dot(q - a, along) / glm::dot(along, along), 0.0, 1.0);
    return glm::mix(radius_a, radius_b, t) - glm::distance(q, a + t * along);
}

double behind(const Vec3& q, const Vec3& normal) {
    return -glm::dot(q, glm::normalize(normal));
}

double within(double squared_distance, double radius) {
    return (radius * radius - squared_distance) / (2 * radius);
}

double Blend::join(std::initializer_list<double> solids) const {
    const double top = std::max(solids);
    double sum = 0;
    for (const double v : solids) sum += std::exp((v - top) / rounding);
    return top + rounding * std::log(sum);
}

double Blend::meet(std::initializer_list<double> solids) const {
    const double low = std::min(solids);
    double sum = 0;
    for (const double v : solids) sum += std::exp((low - v) / rounding);
    return low - rounding * std::log(sum);
}

}  // namespace subvol::model
