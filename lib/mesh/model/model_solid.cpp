// SPDX-License-Identifier: Apache-2.0
#include "model_solid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace subvol::detail::model {
namespace {

std::array<Index, 3> lattice(const Solid& solid, Index resolution) {
    std::array<Index, 3> cells;
    for (int axis = 0; axis < 3; ++axis) {
        const double share = solid.half[axis] / solid.half[solid.main];
        cells[static_cast<std::size_t>(axis)] = std::max<Index>(1, static_cast<Index>(std::lround(resolution * share)));
    }
    return cells;
}

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

double Blend::join(std::initializer_list<double> shapes) const {
    const double top = std::max(shapes);
    double sum = 0;
    for (const double v : shapes) sum += std::exp((v - top) / rounding);
    return top + rounding * std::log(sum);
}

double Blend::meet(std::initializer_list<double> shapes) const {
    const double low = std::min(shapes);
    double sum = 0;
    for (const double v : shapes) sum += std::exp((low - v) / rounding);
    return low - rounding * std::log(sum);
}

Vec3 parameter(const Solid& solid, const Vec3& x) {
    return undo(solid.deformation, x) / solid.half;
}

Vec3 position(const Solid& solid, const Vec3& parameter) {
    return apply(solid.deformation, solid.half * parameter);
}

double density(const Solid& solid, const Vec3& parameter) {
    return std::tanh(solid.distance(solid.half * parameter) / solid.transition);
}

std::optional<double> value(const Solid& solid, const Vec3& x) {
    const Vec3 p = parameter(solid, x);
    if (!in_block(p)) return std::nullopt;
    return density(solid, p);
}

HexMesh make_solid(const Solid& solid, Index resolution) {
    HexMesh mesh = parameter_block(lattice(solid, resolution));
    Attribute field{.name = "density", .channels = 1, .values = std::vector<double>(mesh.points.size())};
    tbb::parallel_for(std::size_t{0}, mesh.points.size(), [&](std::size_t p) {
        field.values[p] = density(solid, mesh.points[p]);
        mesh.points[p] = position(solid, mesh.points[p]);
    });
    mesh.attributes.push_back(std::move(field));
    return mesh;
}

}  // namespace subvol::detail::model
