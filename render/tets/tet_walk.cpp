// SPDX-License-Identifier: Apache-2.0
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
