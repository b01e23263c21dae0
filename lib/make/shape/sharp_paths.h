// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sharp_edges.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// Edges of a mesh's boundary that follow the sharp edges of a surface.
struct SharpPaths {
    std::vector<std::array<Index, 2>> creases;  ///< edges of the mesh, two points each, the smaller first; in ascending order
    std::vector<Index> curves;                  ///< which curve each crease follows
    std::vector<std::array<Index, 2>> cuts;     ///< more edges, by which every path that ends freely goes on to another one
    std::vector<std::pair<Index, Index>> corners;  ///< points of the mesh, and the corner that each takes
    std::vector<Index> missed;  ///< curves that no path follows, as other ones are too near or the mesh does not reach them
};

/// Finds for each curve a path of edges of the boundary near to it. Paths meet in corners alone.
///
/// side: of a cell
[[nodiscard]] SharpPaths sharp_paths(const HexMesh& mesh, const SharpEdges& sharp, double side);

}  // namespace subvol::detail
