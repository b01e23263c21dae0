#include "tet_walk.h"

namespace subvol {

std::optional<CrossedFace> cross_face(const TetMesh& mesh, const RayPlane& plane, TetFace face) {
    CrossedFace crossed;
    const auto ids = mesh.corners(face);
    for (std::size_t k = 0; k < 3; ++k) {
        crossed.corner[k] = plane.see(ids[k], mesh.points[ids[k]].position, mesh.points[ids[k]].value);
    }
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

}  // namespace subvol
