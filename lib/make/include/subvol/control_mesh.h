// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/fit_shape.h"

namespace subvol {

/// cells:     along the longest side of the surface's box
/// max_cells: that may be made
/// rounds:    how often the nearest places are looked for, each time with half as much weight again for distances
/// refine:    how often cubes may be divided into 27, where the boundary or a sharp edge is not met within `tolerance`
/// tolerance: a distance that is near enough, as a part of the side of a cube that is not divided
/// sharp_angle_deg: edges of the surface that are bent by more become creases of the mesh; 180: none
/// scheme, folds, names, progress: as in `FitShapeOptions`; the scheme without an angle of creases
struct ControlMeshOptions {
    SchemeOptions scheme{};
    int cells = 24;
    std::size_t max_cells = 2'000'000;
    int rounds = 15;
    int refine = 0;
    double tolerance = 0.25;
    double sharp_angle_deg = 40;
    ShapeFolds folds{};
    OptionNames names = OptionNames::Keywords;
    Progress* progress = nullptr;
};

/// The options without those of the scheme.
[[nodiscard]] std::vector<Option> options_of(ControlMeshOptions& options);

/// The sharp edges of a surface, as chains, and the creases of a mesh that follow them.
///
/// missed:   chains without creases, as others are too near or the mesh does not reach them
/// rms, max: distances of the creases from the chains
struct SharpEdgeReport {
    std::size_t curves = 0, missed = 0;
    double length_world = 0, missed_length_world = 0;
    std::size_t creases = 0;
    double rms = 0, max = 0;
};

/// What a surface of triangles encloses, and what is odd about it.
///
/// walls:      closed parts of it, that are not joined by edges
/// united:     walls that cross others before them; the mesh is that of their union
/// cavities:   walls within another wall that bound a cavity; alike: those of them with the orientation of the wall around them
/// copies:     triangles that are there twice, which are left out
/// sheets:     triangles of sheets that enclose nothing, which are left out
/// turned:     triangles with another orientation than most of those that they are joined with
/// one_sided:  edges at which no orientation of the triangles agrees
/// many_edges: edges of more than two triangles
struct EnclosureReport {
    std::size_t walls = 0, united = 0, cavities = 0, cavities_alike = 0, copies = 0, sheets = 0, turned = 0, one_sided = 0,
                many_edges = 0;
};

/// shape:      how far the limit's boundary is from the surface; before: as cubes with a layer around them
/// parts:      of the mesh, that are not joined
/// added:      cubes that were needed to make the boundary of the cubes a surface
/// refined, divided: how often cubes were divided, and how many in all
/// side_world: of a cube that is not divided
/// min_scaled_jacobian: of the control cells: 1 for cubes, negative if one is turned inside out at a corner
struct ControlMeshReport {
    FitShapeReport shape;
    SharpEdgeReport sharp;
    EnclosureReport surface;
    std::size_t parts = 0, added = 0;
    int refined = 0;
    std::size_t divided = 0;
    double side_world = 0;
    double min_scaled_jacobian = 0;
};

/// The report under its members' names.
[[nodiscard]] Facts facts_of(const ControlMeshReport& report);

struct ControlMesh {
    HexMesh mesh;
    ControlMeshReport report;
};

/// A mesh of hexahedra whose limit fills a closed surface.
///
/// Cubes of a grid whose middles lie inside become cells, with a layer of cells around them, so that none has two sides at the
/// boundary. Then the distortion of the cells' children is made as small as it can be, while the boundary of the limit is drawn
/// to the surface, more and more; and points are moved where the limit folds still (`mend_folds`). Where the boundary is still
/// too far away, cubes are divided and all is done again. Chains of sharp edges become creases, with a layer of cells on both
/// sides. Where that cannot be, as in chains nearer to each other than a cell, edges become round, by a part of a cell.
///
/// surface: closed; holes are spanned where most of the surface winds about a place, with a warning. Either side may be out.
///          A wall within another is that of a cavity, whatever its orientation; walls that cross are united
/// throws:  Error(InvalidInput) if the surface is not valid, if it is a sheet without volume, if no cube has its middle inside,
///          if it is more than 1e9 cubes away from the origin, if there would be too many cells, or if an option is out of
///          range; Error(Cancelled)
/// cost:    some 1 to 5 ms and 10 kB a cell, more where folds are mended; parallel, the same bits for any number of threads
/// source:  [marechal2009] for layers over cubes, [barill2018] for what is inside, [garanzha2021] for distortions
[[nodiscard]] ControlMesh control_mesh_of(const Surface& surface, const ControlMeshOptions& options = {});

}  // namespace subvol
