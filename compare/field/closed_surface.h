// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "box_tree.h"
#include "subvol/surface.h"

namespace subvol::detail {

/// The inside of a closed surface of outward triangles: points from which a ray leaves the surface more often than it enters
/// it. Shells may be nested or overlap.
class ClosedSurface {
public:
    explicit ClosedSurface(Surface surface);

    [[nodiscard]] bool holds(const Vec3& x) const;
    [[nodiscard]] bool empty() const { return surface_.triangles.empty(); }
    [[nodiscard]] Box bounds() const { return tree_.bounds(); }

private:
    /// +1 or −1 if the ray from x up the z axis leaves or enters through the triangle, else 0.
    [[nodiscard]] int crossing(Index triangle, const Vec3& x) const;

    Surface surface_;
    BoxTree tree_;
};

/// The box of each triangle.
[[nodiscard]] std::vector<Box> triangle_boxes(const Surface& surface);

}  // namespace subvol::detail
