#pragma once

#include <span>

#include "subvol/refine.h"

namespace subvol {

/// Refines some cells of a mesh, and of the others only what their rules need: two layers around.
///
/// cells:   which, without repetition (what a predicate chose); descendants k·8^levels … of cells[k] come in this order
/// returns: the level-`levels` mesh of these cells alone, bitwise as `refine` of the whole mesh has it; its points stand in the
///          order of that mesh. Creases and sharp faces of the part are kept.
/// throws:  Error(InvalidInput) as `refine` (creases are looked at only where they matter), or if a cell does not exist or is
/// named twice cost:    of the cells asked for and their surroundings, besides one pass over the mesh
[[nodiscard]] HexMesh refine_cells(const HexMesh& mesh, std::span<const Index> cells, const RefineOptions& options = {});

}  // namespace subvol
