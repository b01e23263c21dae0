// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "subvol/camera.h"
#include "tet_mesh.h"

namespace subvol::detail {

/// From back to front.
struct TetOrder {
    std::vector<std::uint32_t> tets;
    std::size_t cycles = 0;
};

/// By the eye depth of the centroids; equal ones by their number.
[[nodiscard]] TetOrder order_by_centroid(const TetMesh& mesh, const View& view);

/// A tetrahedron comes after all that are behind its faces; of those that are ready, the one with the farthest centroid is
/// taken. Where cycles leave none ready, the farthest centroid of all is, and `cycles` counts it.
///
/// cost:   O(n log n), the order itself on one thread
/// source: docs/science.md (MPVO; the heuristic for meshes that are not convex is Williams')
[[nodiscard]] TetOrder order_topologically(const TetMesh& mesh, const View& view);

}  // namespace subvol::detail
