// SPDX-License-Identifier: Apache-2.0
#include "model_block.h"

#include <cmath>

namespace subvol::detail::model {
namespace {

/// p turned about an axis by an angle.
Vec3 turned(Vec3 p, int axis, double angle) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const double c = std::cos(angle), s = std::sin(angle);
    const double pa = p[a], pb = p[b];
    p[a] = c * pa - s * pb;
    p[b] = s * pa + c * pb;
    return p;
}

/// p with its section across an axis scaled.
Vec3 scaled(Vec3 p, int axis, double factor) {
    p[(axis + 1) % 3] *= factor;
    p[(axis + 2) % 3] *= factor;
    return p;
}

Vec3 shifted(Vec3 p, int axis, double by) {
    p[axis] += by;
    return p;
}

}  // namespace

bool in_block(const Vec3& p) {
    return std::abs(p.x) <= 1 && std::abs(p.y) <= 1 && std::abs(p.z) <= 1;
}

HexMesh parameter_block(const std::array<Index, 3>& cells) {
    const auto [nx, ny, nz] = cells;
    const auto coordinate = [](Index i, Index n) { return -1 + 2.0 * static_cast<double>(i) / static_cast<double>(n); };
    HexMesh mesh;
    mesh.points.reserve(std::size_t{nx + 1} * (ny + 1) * (nz + 1));
    for (Index k = 0; k <= nz; ++k) {
        for (Index j = 0; j <= ny; ++j) {
            for (Index i = 0; i <= nx; ++i) {
                mesh.points.emplace_back(coordinate(i, nx), coordinate(j, ny), coordinate(k, nz));
            }
        }
    }
    const Index row = nx + 1, layer = row * (ny + 1);
    mesh.cells.reserve(std::size_t{nx} * ny * nz);
    for (Index k = 0; k < nz; ++k) {
        for (Index j = 0; j < ny; ++j) {
            for (Index i = 0; i < nx; ++i) {
                const Index p = i + row * j + layer * k, q = p + layer;
                mesh.cells.push_back({p, p + 1, p + 1 + row, p + row, q, q + 1, q + 1 + row, q + row});
            }
        }
    }
    return mesh;
}

Vec3 Twist::apply(const Vec3& p) const {
    return turned(p, axis, rate * p[axis] + offset);
}

Vec3 Twist::undo(const Vec3& x) const {
    return turned(x, axis, -(rate * x[axis] + offset));
}

Vec3 Bend::apply(const Vec3& p) const {
    Vec3 x = p;
    const double arm = radius + p[towards], angle = p[along] / radius;
    x[towards] = arm * std::cos(angle) - radius;
    x[along] = arm * std::sin(angle);
    return x;
}

Vec3 Bend::undo(const Vec3& x) const {
    // atan2 is in (-π,π]: on both sides of its cut the place along the axis lies beyond the part that is bent.
    Vec3 p = x;
    const double side = radius < 0 ? -1 : 1, arm = x[towards] + radius;
    p[along] = radius * std::atan2(side * x[along], side * arm);
    p[towards] = side * std::hypot(arm, x[along]) - radius;
    return p;
}

Vec3 Swell::apply(const Vec3& p) const {
    return scaled(p, along, 1 + amount * std::sin(rate * p[along] + phase));
}

Vec3 Swell::undo(const Vec3& x) const {
    return scaled(x, along, 1 / (1 + amount * std::sin(rate * x[along] + phase)));
}

Vec3 Sway::apply(const Vec3& p) const {
    return shifted(p, towards, amount * std::sin(rate * p[along] + phase));
}

Vec3 Sway::undo(const Vec3& x) const {
    return shifted(x, towards, -amount * std::sin(rate * x[along] + phase));
}

Vec3 apply(std::span<const Deformation> steps, Vec3 p) {
    for (const Deformation& step : steps) p = std::visit([&](const auto& s) { return s.apply(p); }, step);
    return p;
}

Vec3 undo(std::span<const Deformation> steps, Vec3 x) {
    for (std::size_t k = steps.size(); k-- > 0;) x = std::visit([&](const auto& s) { return s.undo(x); }, steps[k]);
    return x;
}

}  // namespace subvol::detail::model
