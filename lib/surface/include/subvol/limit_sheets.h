// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/limit_surface.h"
#include "subvol/refine_sheets.h"
#include "subvol/surface.h"

namespace subvol {

/// `refine_sheets`, with points and values moved to the limit: those of the mesh to the mesh's limit, all others by the masks
/// of the surface rules, which are exact: (n,4,1)/(n+5) over n quads for Catmull-Clark, (4,4,1)/9 for Bsxw, (1,4,1)/6 along
/// creases and curves.
///
/// throws: Error(InvalidInput) as `refine_sheets`
[[nodiscard]] Sheets limit_sheets(const HexMesh& mesh, const Sheets& sheets, const RefineOptions& options = {});

/// Sheets and curves as triangles, to be drawn.
///
/// points:  of `surface`: those of the sheets, then those of the tubes
/// sources: for each point of the surface the point of the sheets whose values it has
/// sheet_triangles: the first of the triangles, those of the quads: two each; the others are those of the tubes
struct SheetSurface {
    Surface surface;
    std::vector<Index> sources;
    std::size_t sheet_triangles = 0;
};

/// Two triangles for each quad; a tube of eight sides with round ends about each line, but for those on edges of quads.
///
/// tube_radius_world: 0: no tubes
/// throws:            Error(InvalidInput) if the radius is negative or not finite
[[nodiscard]] SheetSurface sheet_surface(const Sheets& sheets, double tube_radius_world);

/// Adds the quads to a surface of the limit, with points of their own, as two triangles each. The report of the surface, such
/// as whether it is watertight, stays that of the volume's surface.
///
/// sheets: with the fields of the surface, in its order; their gradients are 0, and so are the places of the points
/// throws: Error(InvalidInput) if the fields are not the same
void add_sheets(LimitSurface& surface, const Sheets& sheets);

}  // namespace subvol
