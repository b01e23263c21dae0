// SPDX-License-Identifier: Apache-2.0
// Inside and outside of a closed surface: signed crossings of a ray up the z axis.
//
//        ^ ray          A ray leaves the surface through triangles that face up (+1) and enters it through those that face down
//     ___|___ +1        (-1). The sum over the crossings above x is the winding number of the surface about x: positive inside,
//    |   |   |          for nested and overlapping shells too. The candidates are the triangles whose boxes the ray meets.
//    |   x   |  sum 1
//    |_______|          The ray meets a triangle if x is left of all its edges, seen from above, or right of all. An edge is
//                       always evaluated from its smaller point number to its larger, so both of its triangles get the same
//                       bits. An area of exactly 0 is decided as if x were moved by (ε, ε², 0) with an infinitesimal ε, as in
//                       the simulation of simplicity [em1990]: so a ray through an edge or a corner meets one triangle there.
#include "closed_surface.h"

#include <utility>

namespace subvol::detail {

namespace {

constexpr std::size_t kLeafBoxes = 8;

std::vector<Vec3> centers_of(const std::vector<Box>& boxes) {
    std::vector<Vec3> centers;
    centers.reserve(boxes.size());
    for (const Box& box : boxes) centers.push_back(box.center());
    return centers;
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes)
    : tree_(centers_of(boxes), kLeafBoxes, [&](Index item) { return boxes[item]; }) {
    boxes_.reserve(boxes.size());
    for (std::size_t slot = 0; slot < boxes.size(); ++slot) boxes_.push_back(boxes[tree_.item(slot)]);
}

namespace {

double twice_area(const Vec3& a, const Vec3& b, const Vec3& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

// Whether a point is left of the line from a to b, seen from above. area: of the three, which may be 0
bool is_left(double area, const Vec3& a, const Vec3& b) {
    if (area != 0) return area > 0;
    return b.y != a.y ? b.y < a.y : b.x > a.x;
}

}  // namespace

std::vector<Box> triangle_boxes(const Surface& surface) {
    std::vector<Box> boxes(surface.triangles.size());
    for (std::size_t t = 0; t < boxes.size(); ++t) {
        for (const Index corner : surface.triangles[t]) boxes[t].add(surface.points[corner]);
    }
    return boxes;
}

ClosedSurface::ClosedSurface(Surface surface) : surface_(std::move(surface)), tree_(triangle_boxes(surface_)) {
}

int ClosedSurface::crossing(Index triangle, const Vec3& x) const {
    const auto& corners = surface_.triangles[triangle];
    int left = 0;
    std::array<double, 3> areas;
    for (std::size_t k = 0; k < 3; ++k) {
        const bool turned = corners[k] > corners[(k + 1) % 3];
        const Vec3& from = surface_.points[corners[turned ? (k + 1) % 3 : k]];
        const Vec3& to = surface_.points[corners[turned ? k : (k + 1) % 3]];
        const double area = twice_area(from, to, x);
        left += is_left(area, from, to) != turned ? 1 : 0;
        areas[k] = turned ? -area : area;
    }
    if (left != 0 && left != 3) return 0;
    const double sum = areas[0] + areas[1] + areas[2];
    if (sum == 0) return 0;
    const auto z = [&](std::size_t k) { return surface_.points[corners[k]].z; };
    const double height = (areas[1] * z(0) + areas[2] * z(1) + areas[0] * z(2)) / sum;
    if (height < x.z) return 0;
    return left == 3 ? 1 : -1;  // counter-clockwise seen from above: the triangle faces up
}

bool ClosedSurface::holds(const Vec3& x) const {
    const auto above = [&](const Box& box) {
        return box.lower.x <= x.x && x.x <= box.upper.x && box.lower.y <= x.y && x.y <= box.upper.y && x.z <= box.upper.z;
    };
    int left = 0;
    tree_.visit(above, [&](Index triangle) {
        left += crossing(triangle, x);
        return false;
    });
    return left > 0;
}

}  // namespace subvol::detail
