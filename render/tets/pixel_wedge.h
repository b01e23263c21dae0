// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "pixel_tiles.h"
#include "subvol/camera.h"

namespace subvol::detail {

/// The lines of all rays through a part of a picture, before and behind the eye: what lies between two planes through its first
/// and its last row, and between two through its columns.
class PixelWedge {
public:
    /// margin_world: by which the wedge is wider
    PixelWedge(const View& view, const PixelRect& part, double margin_world)
        : rows_{plane(view.ray(0.5 * view.width(), part.y0), view.axes()[0]),
                plane(view.ray(0.5 * view.width(), part.y1), view.axes()[0])},
          columns_{plane(view.ray(part.x0, 0.5 * view.height()), view.axes()[1]),
                   plane(view.ray(part.x1, 0.5 * view.height()), view.axes()[1])},
          margin_(margin_world) {}

    /// False if none of the lines meets the box.
    [[nodiscard]] bool may_touch(const Box& box) const { return meets(rows_, box) && meets(columns_, box); }

private:
    struct Plane {
        Vec3 normal, point;
    };

    static Plane plane(const Ray& ray, const Vec3& axis) {
        return {glm::normalize(glm::cross(ray.direction, axis)), ray.origin};
    }

    /// A line between two planes that meet at the eye has one of them on each side, before the eye as behind it. So a box that
    /// is on the same side of both is beside all lines.
    [[nodiscard]] bool meets(const std::array<Plane, 2>& planes, const Box& box) const {
        bool above = true, below = true;
        for (const Plane& plane : planes) {
            const double distance = glm::dot(plane.normal, box.center() - plane.point);
            const double reach = 0.5 * glm::dot(glm::abs(plane.normal), box.size()) + margin_;
            above = above && distance > reach;
            below = below && distance < -reach;
        }
        return !above && !below;
    }

    std::array<Plane, 2> rows_, columns_;
    double margin_;
};

}  // namespace subvol::detail
