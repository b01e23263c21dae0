// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <utility>

#include "ray_plane.h"
#include "tet_mesh.h"

namespace subvol::detail {

/// Where a ray crosses a face: depth along the ray and the value there.
struct Crossing {
    double t = 0;
    double value = 0;
};

/// A face that the ray crosses: its corners in the ray's coordinates, counter-clockwise about it, and the sides of its edges.
struct CrossedFace {
    std::array<SeenPoint, 3> corner;
    std::array<Side, 3> side;  // of edges 0→1, 1→2, 2→0; all left

    /// Linear interpolation: the three areas are the barycentric weights.
    [[nodiscard]] Crossing crossing() const {
        double w0 = std::max(0.0, side[1].area), w1 = std::max(0.0, side[2].area), w2 = std::max(0.0, side[0].area);
        if (!(w0 + w1 + w2 > 0)) w0 = w1 = w2 = 1;  // seen edge on, to the last bit
        const double scale = 1 / (w0 + w1 + w2);
        return {scale * (w0 * corner[0].t + w1 * corner[1].t + w2 * corner[2].t),
                scale * (w0 * corner[0].value + w1 * corner[1].value + w2 * corner[2].value)};
    }
};

/// The triangle if the ray crosses it.
[[nodiscard]] std::optional<CrossedFace> cross_triangle(const std::array<SeenPoint, 3>& corners);

template <class Mesh>
[[nodiscard]] SeenPoint see(const Mesh& mesh, const RayPlane& plane, Index id) {
    const auto& point = mesh.point(id);
    return plane.see(id, point.position, point.value);
}

template <class Mesh>
[[nodiscard]] std::optional<CrossedFace> cross_face(const Mesh& mesh, const RayPlane& plane, TetFace face) {
    const auto [a, b, c] = mesh.corners(face);
    return cross_triangle({see(mesh, plane, a), see(mesh, plane, b), see(mesh, plane, c)});
}

/// Follows a ray from a boundary face through the mesh to another boundary face. Because the signs of edges are consistent, a
/// tetrahedron that is entered has exactly one other face that the ray crosses. So the walk cannot fail or turn in circles, not
/// even in flat or inverted tetrahedra (there t stands still or runs back).
///
/// face:    `start` as the ray crosses it
/// visit:   bool(Crossing), called at every face crossed after the first; false ends the walk
/// returns: the boundary face at the end; nothing if visit ended the walk
template <class Mesh, class Visit>
std::optional<TetFace> walk(const Mesh& mesh, const RayPlane& plane, TetFace start, CrossedFace face, const Visit& visit) {
    Index tet = start / 4;
    for (;;) {
        auto& [a, b, c] = face.corner;
        const auto& corner = mesh.corners_of_tet(tet);
        const Index apex = corner[0] ^ corner[1] ^ corner[2] ^ corner[3] ^ a.id ^ b.id ^ c.id;
        const SeenPoint d = see(mesh, plane, apex);
        const Side ad = side_of(a, d);
        Index dropped;
        if (!ad.left) {
            if (const Side bd = side_of(b, d); bd.left) {  // a b d
                dropped = c.id;
                c = d;
                face.side[1] = bd;
                face.side[2] = ad.reversed();
            } else {  // b c d
                dropped = a.id;
                a = d;
                face.side[0] = bd.reversed();
                face.side[2] = side_of(c, d);
            }
        } else if (const Side cd = side_of(c, d); cd.left) {  // b c d
            dropped = a.id;
            a = d;
            face.side[0] = side_of(b, d).reversed();
            face.side[2] = cd;
        } else {  // c a d
            dropped = b.id;
            b = d;
            face.side[0] = ad;
            face.side[1] = cd.reversed();
        }
        if (!visit(face.crossing())) return std::nullopt;
        const auto k = static_cast<Index>(std::find(corner.begin(), corner.end() - 1, dropped) - corner.begin());
        const Index next = mesh.neighbor(tet, k);
        if (next == kNone) return 4 * tet + k;
        tet = next;
    }
}

}  // namespace subvol::detail
