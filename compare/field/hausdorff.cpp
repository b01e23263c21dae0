// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "closed_surface.h"
#include "sample_grid.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/triangle_distance.h"
#include "subvol/field_metrics.h"

namespace subvol {

namespace {

double one_sided(const Surface& from, const Surface& to) {
    const detail::BoxTree tree(detail::triangle_boxes(to));
    std::vector<double> distances(from.points.size());
    tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t i) {
        const Vec3& x = from.points[i];
        distances[i] = tree.nearest(x, [&](Index triangle) {
            const auto& t = to.triangles[triangle];
            return detail::squared_distance(x, to.points[t[0]], to.points[t[1]], to.points[t[2]]);
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
