// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/refine.h"

namespace subvol::detail {

// The steps of `refine`, for calls that need what lies between them.

/// throws: Error(InvalidInput) unless levels is 0 to 10
void check_levels(int levels);

/// The mesh from which a scheme starts: validated, without its unused points, with the creases that scheme.crease_angle_deg
/// finds.
///
/// levels: how many times the mesh will be refined; level 0 needs no creases
/// throws: Error(InvalidInput) as `check_levels`, `validate` and `tag_creases`
[[nodiscard]] HexMesh control_mesh(HexMesh mesh, const SchemeOptions& scheme, int levels = 1);

/// A refined mesh without its cells, which are child_cells(parent).
struct RefinedPoints {
    HexMesh mesh;
    Topology parent;  // of the level before
};

/// As `refine`, for a valid mesh with its creases and its topology. options.levels: ≥ 1; options.scheme.crease_angle_deg is not
/// used
[[nodiscard]] RefinedPoints refine_points(HexMesh control, Topology topology, const RefineOptions& options);

/// Takes the fields at cells out of a mesh, with a copy of its cells; no cells if there is none.
[[nodiscard]] HexMesh take_cell_fields(HexMesh& mesh);

/// Gives a refined mesh the fields at cells: all eight children of a cell have its value, so each cell keeps its mean, however
/// large they are. The values at points of fields that are constant in cells become means over the children there.
///
/// control: as from `take_cell_fields`
/// cells:   those that were refined, in order; their descendants follow each other in `fine`
void inherit_cells(const HexMesh& control, std::span<const Index> cells, int levels, HexMesh& fine);

}  // namespace subvol::detail
