// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "foam_text.h"
#include "mesh_file.h"

namespace subvol::detail {

/// A mesh as OpenFOAM has it. owner, neighbour: the cells of each face; only the first faces have a neighbour. The normal of a
/// face points out of its owner
struct FoamMesh {
    FoamFaces faces;
    std::vector<std::int64_t> owner, neighbour;
    std::size_t cells = 0;
};

/// Checks all numbers, and counts the cells. fail: throws an Error with a sentence
void check_foam_mesh(FoamMesh& mesh, std::size_t points, const std::function<void(const std::string&)>& fail);

/// Adds the cells to `found`, which has the points: as the hexahedra, prisms, pyramids and tetrahedra that their faces make
/// them. Others are split from a new point in their middle into tetrahedra, with a warning that counts them.
///
/// ignore_others: only the hexahedra
void add_foam_cells(const FoamMesh& mesh, bool ignore_others, MeshFile& found);

}  // namespace subvol::detail
