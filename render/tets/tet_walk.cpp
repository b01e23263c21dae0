// SPDX-License-Identifier: Apache-2.0
// How a ray decides which face of a tetrahedron it crosses.
//
// Seen along the ray, space is a plane and the ray is its origin, *. An edge a→b has * on its left or on its right: the sign of
// the area a.x·b.y − b.x·a.y. The ray crosses a triangle if * is on the same side of all three edges:
//
//            c          All three signs are alike: the ray crosses the triangle. The areas of (*,b,c), (*,c,a) and (*,a,b)
//           / \         are the barycentric weights of the crossing, so depth and value follow by interpolation.
//          / * \        Otherwise it passes beside the triangle.
//         a-----b
//
// Plane tests in floating point contradict each other at vertices, edges and in flat cells, and the ray is lost. A sign belongs
// to an edge, not to a cell: it is computed in the same way for all cells about the edge, exactly where it is close to zero,
// and is never zero (ties by simulation of simplicity [em1990]). Hence a tetrahedron that a ray enters through one face has
// exactly one other crossed face, and `walk` (tet_walk.h) needs only the signs of the edges to the fourth corner to find it.
// The walk from cell to cell is that of [garrity1990]; docs/adr/0005 says why signs, docs/adr/0013 how rays go side by side.
#include "tet_walk.h"

namespace subvol::detail {

std::optional<CrossedFace> cross_triangle(const std::array<SeenPoint, 3>& corners) {
    CrossedFace crossed;
    crossed.corner = corners;
    auto& [a, b, c] = crossed.corner;
    auto& [ab, bc, ca] = crossed.side;
    ab = side_of(a, b);
    bc = side_of(b, c);
    if (ab.left != bc.left) return std::nullopt;
    ca = side_of(c, a);
    if (ca.left != ab.left) return std::nullopt;
    if (!ab.left) {  // clockwise: exchange b and c
        std::swap(b, c);
        const Side old_ab = ab;
        ab = ca.reversed();
        bc = bc.reversed();
        ca = old_ab.reversed();
    }
    return crossed;
}

}  // namespace subvol::detail
