// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/limit_surface.h"
#include "subvol/refine_shells.h"
#include "subvol/surface.h"

namespace subvol {

/// `refine_shells`, with points and values moved to the limit: those of the mesh to the mesh's limit, all others by the masks
/// of the surface rules, which are exact: (n,4,1)/(n+5) over n quads for Catmull-Clark, (4,4,1)/9 for Bsxw, (1,4,1)/6 along
/// creases and beams.
///
/// throws: Error(InvalidInput) as `refine_shells`
[[nodiscard]] Shells limit_shells(const HexMesh& mesh, const Shells& shells, const RefineOptions& options = {});

/// Shells and beams as triangles, to be drawn.
struct ShellSurface {
    Surface surface;             ///< the points and triangles of the shells, then those of the tubes
    std::vector<Index> sources;  ///< for each point of the surface the point of the shells and beams whose values it has
    /// Number of triangles of the shells, two for each quad; the triangles of the tubes follow them
    std::size_t shell_triangles = 0;
};

/// Two triangles for each quad; a tube of eight sides with round ends around each line that is not an edge of a quad.
///
/// tube_radius_world: radius of the tubes; 0 makes none
/// throws:            Error(InvalidInput) if the radius is negative or not finite
[[nodiscard]] ShellSurface shell_surface(const Shells& shells, double tube_radius_world);

/// Adds the quads to a surface of the limit, with points of their own, as two triangles each. The report of the surface, such
/// as whether it is watertight, stays that of the volume's surface.
///
/// shells: with the fields of the surface, in its order; their gradients are 0, and so are the places of the points
/// throws: Error(InvalidInput) if the fields are not the same
void add_shells(LimitSurface& surface, const Shells& shells);

}  // namespace subvol
