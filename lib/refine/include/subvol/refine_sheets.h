// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/refine.h"
#include "subvol/sheets.h"

namespace subvol {

/// Refines sheets and curves beside a mesh; each level splits a quad into four and a line into two. The mesh is refined only
/// about the points that are its own too: these follow it, with the bits of `refine`. All else is refined by the scheme's rules
/// for the boundary of a mesh, with the points of the sheets and curves alone.
///
/// Edges of sheets are creases where they have other than two quads, lie on an edge of a cell or have a curve along them. A
/// point of two creases lies on a smooth curve; it stays if it has another number of creases, if only one quad is there at a
/// free edge, or where sheets touch in that point alone. A curve is smooth where two lines meet away from cells and sheets;
/// elsewhere it ends, and follows these.
///
/// Numbering of points: the parent's, one for each edge of the quads and for each quad, and one for each line that is no edge
/// of a quad. Children of quad q are 4q to 4q + 3, those of line l are 2l and 2l + 1. throws: Error(InvalidInput) as `refine`
/// and `validate` cost:   one thread for the sheets; the mesh as `refine_cells` for the cells within two layers of the sheets
/// source: our choice of rules; the idea of one scheme for volumes, sheets and curves is that of [cq2006]
[[nodiscard]] Sheets refine_sheets(const HexMesh& mesh, const Sheets& sheets, const RefineOptions& options = {});

}  // namespace subvol
