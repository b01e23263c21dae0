// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "mesh_file.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"
#include "subvol/patch_values.h"

namespace subvol::detail {

struct FileSetsOfMesh {
    MeshSets sets;
    /// Sides of the mesh that lie on faces of the patches. Their numbers count the faces of all patches, one patch after the
    /// other
    std::vector<ValuesOnPatches::Side> sides;
};

/// The patches and sets of a file as those of the mesh that was made of it. Faces between two cells of the mesh belong to no
/// patch; patches that have only such faces are left out, with a warning.
///
/// cell_numbers: the number in the file of each cell of the mesh; empty if it is the same
/// sources:      the points of the file whose mean each point of the mesh is, if its cells were split; else null
[[nodiscard]] FileSetsOfMesh sets_of_mesh(const HexMesh& mesh, const MeshFile& found, std::span<const Index> cell_numbers,
                                          const IndexRows* sources, ReadResult& read);

}  // namespace subvol::detail
