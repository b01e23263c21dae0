// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/surface.h"

namespace subvol::detail {

/// A side of a triangle, from its corner `side` to the next one.
struct TriangleSide {
    std::array<Index, 2> ends;  ///< the edge by its points, the smaller first, of which those at the same place are one
    Index triangle, side;
    bool forward;  ///< it runs from the first end to the second
};

/// For each point the first one at the same place. same_place: how far apart points are that are the same
[[nodiscard]] std::vector<Index> welded_points(const Surface& surface, double same_place);

/// The sides of all triangles, those of an edge one after the other. Sides without length are left out.
///
/// same_place: how far apart points are that are the same
[[nodiscard]] std::vector<TriangleSide> sides_of(const Surface& surface, double same_place);

/// Calls visit(sides) for each edge.
template <class Visit>
void each_edge(std::span<const TriangleSide> sides, const Visit& visit) {
    for (std::size_t k = 0, end = 0; k < sides.size(); k = end) {
        while (end < sides.size() && sides[end].ends == sides[k].ends) ++end;
        visit(sides.subspan(k, end - k));
    }
}

}  // namespace subvol::detail
