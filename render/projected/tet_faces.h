// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "subvol/camera.h"
#include "tet_mesh.h"

namespace subvol::detail {

/// The faces of tetrahedra, shared ones once.
///
/// faces: first those that a ray enters or leaves by, or where cells fold over; then those inside, as if drawn at random, large
///        ones sooner, but always the same: the first n of them lie about the mesh evenly, and are among the first n + 1
struct TetFaces {
    struct Face {
        std::array<Index, 3> corner;  // ascending
        std::uint32_t cover;          // 2 + tetrahedra on the side of the face's normal − those on the other
    };
    std::vector<Face> faces;
    std::size_t outer = 0;

    /// How many faces there are with a fraction of those inside, rounded up.
    [[nodiscard]] std::size_t count(double fraction) const;
};

/// cost: O(n log n), parallel; 16 bytes a face and 12 more while it sorts
[[nodiscard]] TetFaces find_faces(const TetMesh& mesh);

/// Numbers of the first `count` faces from front to back, by the eye depth of their centroids; equal ones by their number.
[[nodiscard]] std::vector<std::uint32_t> order_faces(const TetMesh& mesh, const TetFaces& faces, std::size_t count,
                                                     const View& view);

/// The value in the tetrahedron that a point is in, or is nearest to being in.
[[nodiscard]] double value_at(const TetMesh& mesh, const Vec3& point);

}  // namespace subvol::detail
