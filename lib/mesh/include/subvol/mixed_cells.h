// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// Cells other than the hexahedra of a mesh, as point ids.
struct MixedCells {
    std::vector<std::array<Index, 4>> tets;      ///< four corners
    std::vector<std::array<Index, 6>> prisms;    ///< a triangle, then the triangle above it (VTK's wedge)
    std::vector<std::array<Index, 5>> pyramids;  ///< the four corners of the base in cyclic order, then the apex

    [[nodiscard]] bool empty() const { return tets.empty() && prisms.empty() && pyramids.empty(); }
};

/// Splits every cell of a mixed mesh into hexahedra, one for each corner: a tetrahedron into 4, a prism into 6, a hexahedron
/// into 8.
///
/// The points are the used points, then one in the middle of each edge, each face and each cell: the mean of its corners. Each
/// kind is in the order of the sorted corners, which does not depend on the order of the cells. Attributes are means too. The
/// cells are the children of the hexahedra, the tetrahedra and the prisms, in their order.
///
/// Four edges meet at the apex of a pyramid, so it has no such split. If there is a pyramid, all cells are cut into tetrahedra
/// first (a hexahedron into 6, a prism into 3, a pyramid into 2), each quad along the diagonal from its smallest id, so that
/// neighbours agree.
///
/// others: of either handedness, ids into hexes.points; cells that are left-handed by their volume are turned
/// hexes:  may have no cells; must not have creases and sharp faces
/// throws: Error(InvalidInput) if there is no cell, an id is out of range or twice in a cell, two cells have the same corners,
///         or hexes has creases or sharp faces. Faces with more than two cells are found by `build_topology` of the result
/// cost:   O(n log n)
[[nodiscard]] HexMesh split_into_hexes(const HexMesh& hexes, const MixedCells& others);

}  // namespace subvol
