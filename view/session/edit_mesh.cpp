// SPDX-License-Identifier: Apache-2.0
#include "subvol/edit_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "subvol/error.h"

namespace subvol {

namespace {

double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

Vec3 unit(const Vec3& v) {
    const double length = glm::length(v);
    if (!(length > 0)) throw Error(ErrorCode::InvalidInput, "a direction has no length");
    return v / length;
}

Vec3 turned(const Vec3& v, const Vec3& axis, double angle) {
    return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) + axis * glm::dot(axis, v) * (1 - std::cos(angle));
}

/// Calls edit(point) for the selected points, and moves each towards the result by its share.
template <class Edit>
void each_selected(HexMesh& mesh, const Selection& selection, const Edit& edit) {
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        if (selection[p] == 0) continue;
        Vec3& point = mesh.points[p];
        point = selection[p] == 1 ? edit(point) : glm::mix(point, edit(point), selection[p]);
    }
}

/// The least and the largest coordinate of the selected points along a direction.
struct Extent {
    double low = std::numeric_limits<double>::infinity(), high = -low;

    Extent(const HexMesh& mesh, const Selection& selection, const Vec3& center, const Vec3& axis) {
        for (std::size_t p = 0; p < mesh.points.size(); ++p) {
            if (selection[p] == 0) continue;
            const double along = glm::dot(mesh.points[p] - center, axis);
            low = std::min(low, along);
            high = std::max(high, along);
        }
    }
    [[nodiscard]] bool empty() const { return !(low < high); }
};

}  // namespace

Selection select_box(const HexMesh& mesh, const Box& box) {
    Selection selection;
    selection.reserve(mesh.points.size());
    for (const Vec3& p : mesh.points) {
        const bool inside = glm::min(glm::max(p, box.lower), box.upper) == p;
        selection.push_back(inside ? 1 : 0);
    }
    return selection;
}

Selection select_ball(const HexMesh& mesh, const Vec3& center, double radius_world) {
    Selection selection;
    selection.reserve(mesh.points.size());
    for (const Vec3& p : mesh.points) {
        const Vec3 d = (p - center) / radius_world;
        const double rest = std::max(0.0, 1 - glm::dot(d, d));
        selection.push_back(rest * rest);
    }
    return selection;
}

Selection select_pixels(const HexMesh& mesh, const View& view, const Vec2& first, const Vec2& last) {
    const Vec2 low = glm::min(first, last), high = glm::max(first, last);
    Selection selection;
    selection.reserve(mesh.points.size());
    for (const Vec3& p : mesh.points) {
        const Vec3 eye = view.to_eye(p);
        const Vec2 at = view.to_pixels(eye);
        const bool seen = eye.z > 0;
        selection.push_back(seen && at.x >= low.x && at.x <= high.x && at.y >= low.y && at.y <= high.y ? 1 : 0);
    }
    return selection;
}

Vec3 middle_of(const HexMesh& mesh, const Selection& selection) {
    Vec3 sum(0.0);
    double weight = 0;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        sum += selection[p] * mesh.points[p];
        weight += selection[p];
    }
    if (!(weight > 0)) throw Error(ErrorCode::InvalidInput, "no control point is selected");
    return sum / weight;
}

void move_points(HexMesh& mesh, const Selection& selection, const Vec3& by) {
    each_selected(mesh, selection, [&](const Vec3& p) { return p + by; });
}

void rotate_points(HexMesh& mesh, const Selection& selection, const Vec3& center, const Vec3& axis, double angle_deg) {
    const Vec3 about = unit(axis);
    each_selected(mesh, selection, [&](const Vec3& p) { return center + turned(p - center, about, radians(angle_deg)); });
}

void scale_points_about(HexMesh& mesh, const Selection& selection, const Vec3& center, const Vec3& factors) {
    each_selected(mesh, selection, [&](const Vec3& p) { return center + factors * (p - center); });
}

void twist_points(HexMesh& mesh, const Selection& selection, const Vec3& center, const Vec3& axis, double angle_deg) {
    const Vec3 about = unit(axis);
    const Extent extent(mesh, selection, center, about);
    if (extent.empty()) return;
    each_selected(mesh, selection, [&](const Vec3& p) {
        const double part = (glm::dot(p - center, about) - extent.low) / (extent.high - extent.low);
        return center + turned(p - center, about, part * radians(angle_deg));
    });
}

void bend_points(HexMesh& mesh, const Selection& selection, const Vec3& center, const Vec3& axis, const Vec3& toward,
                 double angle_deg) {
    const Vec3 along = unit(axis), side = unit(toward - glm::dot(toward, along) * along);
    const Extent extent(mesh, selection, center, along);
    if (extent.empty() || angle_deg == 0) return;
    // The middle line from `low` up becomes an arc of this radius, with its centre towards `side`.
    const double radius = (extent.high - extent.low) / radians(angle_deg);
    each_selected(mesh, selection, [&](const Vec3& p) {
        const Vec3 d = p - center;
        const double up = glm::dot(d, along) - extent.low, out = glm::dot(d, side);
        const Vec3 across = d - glm::dot(d, along) * along - out * side;
        const double angle = up / radius, arm = radius - out;
        return center + across + (extent.low + arm * std::sin(angle)) * along + (radius - arm * std::cos(angle)) * side;
    });
}

void paint_values(std::span<double> values, const Selection& selection, double value, double strength) {
    for (std::size_t p = 0; p < values.size(); ++p) values[p] += selection[p] * strength * (value - values[p]);
}

}  // namespace subvol
