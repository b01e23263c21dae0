// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/refine.h"
#include "subvol/shells.h"

namespace subvol {

/// Refines shells and beams beside a mesh; each level splits a quad into four and a line into two. The mesh is refined only
/// around the points that shells and beams share with it: these points follow the mesh, with the bits of `refine`. All other
/// points are refined by the scheme's rules for the boundary of a mesh, from the points of the shells and beams alone.
///
/// An edge of a shell is a crease if it does not have exactly two quads, if it lies on an edge of a cell, or if a beam lies
/// along it. A point with exactly two creases moves along them as on a smooth curve. A point stays where it is if it has
/// another number of creases, if it is the corner of a free edge with a single quad, or if shells touch in that point alone. A
/// beam is smooth where two lines meet away from cells and shells; elsewhere it ends, and its end follows the cell or shell
/// there.
///
/// Numbering of points: the parent's points, then one for each edge of the quads, one for each quad, and one for each line that
/// is not an edge of a quad. The children of quad q are 4q to 4q + 3, those of line l are 2l and 2l + 1.
///
/// throws: Error(InvalidInput) as `refine` and `validate`
/// cost:   one thread for the shells; the mesh as `refine_cells` for the cells within two layers of the shells
/// source: our choice of rules; the idea of one scheme for volumes, shells and beams is that of [cq2006]
[[nodiscard]] Shells refine_shells(const HexMesh& mesh, const Shells& shells, const RefineOptions& options = {});

}  // namespace subvol
