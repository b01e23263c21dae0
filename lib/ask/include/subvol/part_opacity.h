// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"
#include "subvol/region.h"
#include "subvol/shells.h"

namespace subvol {

/// A part of a solid whose surface has an opacity of its own, such as "casing=.2" or "half:0,0,0,1,0,0=.3".
struct PartOpacity {
    Region region;       ///< a Region, or the name of a set of cells or, as block:NAME too, of a block
    double opacity = 1;  ///< 0 to 1; 0: the part is not drawn, 1: it is drawn as the rest
};

/// throws: Error(InvalidInput) if it is not a region, an equals sign and a number from 0 to 1
[[nodiscard]] PartOpacity parse_part_opacity(const std::string& text);

/// A mesh without its translucent parts, and these.
struct TranslucentParts {
    HexMesh rest;                     ///< what is opaque; it may have no cells
    std::vector<std::uint8_t> cells;  ///< a flag for each cell: whether it is in the rest
    /// The sides of translucent parts, each part with its own points, as of `patch_shells` of the mesh that was given; what two
    /// parts share is there once, and sides that a part shares with the rest are left out, as the rest has them
    Shells shells;
    std::vector<float> opacities;  ///< opacity of each quad of the shells
};

/// Takes the translucent parts out of a mesh. A cell that several parts have belongs to the last of them.
///
/// sets:   those of the mesh that regions may name
/// throws: Error(InvalidInput) as `cells_in`, or if nothing of the mesh is left to be seen
[[nodiscard]] TranslucentParts translucent_parts(const HexMesh& mesh, std::span<const PartOpacity> parts,
                                                 const MeshSets& sets = {});

}  // namespace subvol
