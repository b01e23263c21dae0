// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "subvol/camera.h"
#include "tet_mesh.h"

namespace subvol::detail {

/// The faces of tetrahedra; shared faces are listed once.
struct TetFaces {
    struct Face {
        std::array<Index, 3> corner;  // ascending
        std::uint32_t cover;          // 2 + tetrahedra on the side of the face's normal − those on the other
    };
    /// First the faces by which rays enter or leave, or at which cells fold over; then the inner ones in a reproducible random
    /// order that favours large faces, so that the first n of them are spread evenly over the mesh for every n.
    std::vector<Face> faces;
    std::size_t outer = 0;

    /// The number of faces that are drawn with a fraction of the inner ones, rounded up.
    [[nodiscard]] std::size_t count(double fraction) const;
};

/// cost: O(n log n), parallel; 16 bytes for each face and 12 more while it sorts
[[nodiscard]] TetFaces find_faces(const TetMesh& mesh);

/// Numbers of the first `count` faces from front to back, by the eye depth of their centroids; equal ones by their number.
[[nodiscard]] std::vector<std::uint32_t> order_faces(const TetMesh& mesh, const TetFaces& faces, std::size_t count,
                                                     const View& view);

/// The value at a point in the tetrahedron that contains it, or that comes closest to containing it.
[[nodiscard]] double value_at(const TetMesh& mesh, const Vec3& point);

}  // namespace subvol::detail
