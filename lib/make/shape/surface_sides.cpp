// SPDX-License-Identifier: Apache-2.0
#include "surface_sides.h"

#include <algorithm>

#include "subvol/detail/point_welder.h"

namespace subvol::detail {

std::vector<Index> welded_points(const Surface& surface, double same_place) {
    PointWelder welder(surface.points, same_place);
    std::vector<Index> first(surface.points.size());
    for (Index p = 0; p < first.size(); ++p) first[p] = welder.join(p);
    return first;
}

std::vector<TriangleSide> sides_of(const Surface& surface, double same_place) {
    const std::vector<Index> first = welded_points(surface, same_place);
    std::vector<TriangleSide> sides;
    sides.reserve(3 * surface.triangles.size());
    for (Index t = 0; t < surface.triangles.size(); ++t) {
        const auto& corners = surface.triangles[t];
        for (Index k = 0; k < 3; ++k) {
            const Index a = first[corners[k]], b = first[corners[(k + 1) % 3]];
            if (a != b) sides.push_back({{std::min(a, b), std::max(a, b)}, t, k, a < b});
        }
    }
    std::ranges::sort(sides, {}, [](const TriangleSide& s) { return std::pair(s.ends, s.triangle); });
    return sides;
}

}  // namespace subvol::detail
