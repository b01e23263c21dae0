// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/mixed_mesh.h"

namespace subvol::detail {

/// A mixed mesh in hexahedra (`in_hexahedra`), and the cell that each of these is in.
///
/// cells: counted through the tetrahedra, octahedra, prisms, pyramids and hexahedra
struct HexesOfMixed {
    HexMesh mesh;
    std::vector<Index> cells;
};

[[nodiscard]] HexesOfMixed hexahedra_of(const MixedMesh& mesh);

/// throws: Error(InvalidInput) unless schemes of tetrahedra refine so often
void check_tet_levels(int levels);

}  // namespace subvol::detail
