// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "closed_surface.h"
#include "sample_grid.h"
#include "subvol/detail/number_text.h"
#include "subvol/field_metrics.h"

namespace subvol {

namespace {

/// The square of the distance from x to a triangle: to its plane if x projects into the triangle, else to the nearest edge.
double squared_distance(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto to_edge = [&](const Vec3& p, const Vec3& q) {
        const Vec3 d = q - p;
        const double length2 = glm::dot(d, d);
        const double t = length2 > 0 ? std::clamp(glm::dot(x - p, d) / length2, 0.0, 1.0) : 0;
        const Vec3 off = x - (p + t * d);
        return glm::dot(off, off);
    };
    const Vec3 normal = glm::cross(b - a, c - a);
    const double area2 = glm::dot(normal, normal);
    const auto inside = [&](const Vec3& p, const Vec3& q) { return glm::dot(glm::cross(q - p, x - p), normal) >= 0; };
    if (area2 > 0 && inside(a, b) && inside(b, c) && inside(c, a)) {
        const double height = glm::dot(x - a, normal);
        return height * height / area2;
    }
    return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

double one_sided(const Surface& from, const Surface& to) {
    const detail::BoxTree tree(detail::triangle_boxes(to));
    std::vector<double> distances(from.points.size());
    tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t i) {
        const Vec3& x = from.points[i];
        distances[i] = tree.nearest(x, [&](Index triangle) {
            const auto& t = to.triangles[triangle];
            return squared_distance(x, to.points[t[0]], to.points[t[1]], to.points[t[2]]);
        });
    });
    return std::sqrt(*std::max_element(distances.begin(), distances.end()));
}

}  // namespace

double hausdorff_distance(const Surface& a, const Surface& b) {
    if (a.triangles.empty() && b.triangles.empty()) return 0;
    if (a.triangles.empty() || b.triangles.empty()) return std::numeric_limits<double>::infinity();
    return std::max(one_sided(a, b), one_sided(b, a));
}

IsosurfaceDistance isosurface_distance(const FieldView& test, const FieldView& reference, double iso, int resolution,
                                       Progress* progress) {
    const Box box = detail::box_about(test.box, reference.box);
    const Surface a = isosurface(test, iso, box, resolution, progress);
    const Surface b = isosurface(reference, iso, box, resolution, progress);
    if (a.triangles.empty() && b.triangles.empty()) {
        throw Error(ErrorCode::InvalidInput, "neither field takes the value " + detail::number_text(iso) + " in its domain");
    }
    return {hausdorff_distance(a, b), detail::SampleGrid(box, resolution).spacing(), a.triangles.size(), b.triangles.size()};
}

}  // namespace subvol
