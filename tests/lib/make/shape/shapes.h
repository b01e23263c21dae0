// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>

#include "lib/test_meshes.h"
#include "subvol/surface.h"

namespace subvol::test {

/// The boundary of a box of small cells, with its points moved; outside is where the normals point.
inline Surface moved_box(int cells, const std::function<Vec3(const Vec3&)>& move) {
    HexMesh box = make_box(static_cast<Index>(cells), static_cast<Index>(cells), static_cast<Index>(cells));
    const Box bounds_of_box = bounds(box);
    for (Vec3& x : box.points) x = move(2.0 * (x - bounds_of_box.center()) / bounds_of_box.size());
    return boundary_surface(box);
}

inline Surface sphere(int cells, double radius = 1) {
    return moved_box(cells, [=](const Vec3& x) {  // evenly by angles
        const Vec3 t(std::tan(x.x * std::atan(1.0)), std::tan(x.y * std::atan(1.0)), std::tan(x.z * std::atan(1.0)));
        return glm::length(t) > 0 ? radius * t / glm::length(t) : t;
    });
}

}  // namespace subvol::test
