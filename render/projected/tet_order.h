// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "subvol/camera.h"
#include "tet_mesh.h"

namespace subvol::detail {

struct TetOrder {
    std::vector<std::uint32_t> tets;  ///< the tetrahedra from back to front
    std::size_t cycles = 0;           ///< how often no tetrahedron was ready
};

/// Sorts by the eye depth of the centroids; equal ones by their number.
[[nodiscard]] TetOrder order_by_centroid(const TetMesh& mesh, const View& view);

/// Puts each tetrahedron after all that are behind its faces; of those that are ready, the one with the farthest centroid is
/// taken. Where cycles leave none ready, the one with the farthest centroid of all is taken.
///
/// cost:   O(n log n), the order itself on one thread
/// source: williams1992 (MPVO, and its heuristic for meshes that are not convex), mhc1990
[[nodiscard]] TetOrder order_topologically(const TetMesh& mesh, const View& view);

}  // namespace subvol::detail
