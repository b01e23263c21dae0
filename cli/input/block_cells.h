// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common_options.h"
#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_io.h"

namespace subvol::cli {

/// The block of each cell of a mesh, as a number among `names`. Both are empty if the mesh has fewer than two blocks.
struct BlockCells {
    std::vector<Index> groups;
    std::vector<std::string> names;
};

/// Reads the blocks of the input one by one, and looks for their cells in the mesh. Cells that are in no block, such as curved
/// ones that are split in another way alone, belong to one more part, "(others)", with a warning.
[[nodiscard]] WithFacts<BlockCells> cells_of_blocks(const std::string& input, const std::vector<MeshBlock>& blocks,
                                                    const HexMesh& mesh, const CommonOptions& options);

}  // namespace subvol::cli
