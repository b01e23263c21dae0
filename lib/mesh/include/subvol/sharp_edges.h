// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "subvol/hex_mesh.h"

namespace subvol {

/// An edge of the boundary is sharp if its two faces meet at more than this, convex or re-entrant.
inline constexpr double kSharpAngleDeg = 40;
/// Up to this angle, an edge of a curve is not sharp: a hole of eight cells around bends by 45 degrees at each of its edges.
inline constexpr double kCurveAngleDeg = 60;

/// What `keep_sharp_edges` made of a mesh.
struct SharpEdges {
    /// Edges that became creases. Edges of a single cell are creases without a tag, and are not counted
    std::size_t edges = 0;
    bool steps = false;  ///< all of them are right angles and many are re-entrant, as on the stairs of voxels
};

/// Tags the sharp edges of the boundary as creases, so that the limit keeps the edges and corners of the mesh: the rule by
/// which meshes of other programs are read. Points where three creases or more meet stay.
///
/// An edge that bends by more than `kSharpAngleDeg` is sharp, except on a curve: at most `kCurveAngleDeg`, and behind the faces
/// on both sides, which are about equally wide, the boundary turns on in the same direction, by at least half as much and
/// without a sharp edge. So the eight sides of a coarse hole make a round hole, while a chamfer is kept.
///
/// mesh:   one with creases or sharp faces of its own gets more of them
/// throws: nothing; faces of more than two cells, which other calls refuse, are left out
/// cost:   O(n log n) time, about 150 bytes per cell
SharpEdges keep_sharp_edges(HexMesh& mesh);

}  // namespace subvol
