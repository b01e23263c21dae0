// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/points_frame.h"

#include <algorithm>

namespace subvol::detail {

namespace {

Box box_around(const std::vector<Vec3>& points) {
    Box box;
    for (const Vec3& p : points) box.add(p);
    return box;
}

/// Whether the centres reach to the boundary on all sides.
bool reach_boundary(const RbfVolume& volume, const Box& centers) {
    if (volume.boundary.points.empty() || volume.centers.empty()) return false;
    constexpr double kNear = .01;  // of the diagonal; views have margins of 5 %
    const Box boundary = box_around(volume.boundary.points);
    const Vec3 gap = glm::max(glm::abs(centers.lower - boundary.lower), glm::abs(centers.upper - boundary.upper));
    return std::max({gap.x, gap.y, gap.z}) <= kNear * boundary.diagonal();
}

}  // namespace

Box frame_of(const RbfVolume& volume) {
    const Box centers = box_around(volume.centers);
    return reach_boundary(volume, centers) ? centers : volume.bounds;
}

std::vector<Vec3> outline_of(const RbfVolume& volume) {
    if (volume.boundary.points.empty()) return {};
    return reach_boundary(volume, box_around(volume.centers)) ? volume.centers : volume.boundary.points;
}

}  // namespace subvol::detail
