// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Control meshes: hexahedral cells with points, fields, sharp edges and faces; what can be said of them before any
/// subdivision.
///
/// - `HexMesh`: points, cells of eight of them, fields at points or cells (`Attribute`), creases and sharp faces.
/// - `MixedCells`: tetrahedra, prisms, pyramids, which `split_into_hexes` makes hexahedra of.
/// - `Topology`: which cells, faces, edges and points are neighbours, and the boundary.
/// - `MeshSource`: a mesh in memory, or one that comes piece by piece.
/// - `MeshSets`, `Shells`: named cells and patches; faces and lines that belong to no cell.
/// - `MeshReport`: counts, volumes, inverted cells (`mesh_report.cpp`).
///
/// Rooms: `mesh` (what concerns one cell at a time, sets, search trees), `topology` (neighbours, the boundary, the report),
/// `model` (meshes from formulas: the table is in `model.cpp`; `expression.h` evaluates formulas of x, y, z for them).
///
///     points, cells, fields ──► HexMesh ──► build_topology ──► Topology ──► (subdivision)
///                                  │
///                                  ├── keep_sharp_edges, bound_as_given, moved_cells: what is changed before
///                                  └── inspect, range_of, boundary_surface: what is said of it
///     make_model("ball", 4) ───► HexMesh

#include "subvol/cell.h"
#include "subvol/expression.h"
#include "subvol/field_bounds.h"
#include "subvol/field_range.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_motion.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_sets.h"
#include "subvol/mesh_source.h"
#include "subvol/mixed_cells.h"
#include "subvol/model.h"
#include "subvol/patch_values.h"
#include "subvol/sharp_edges.h"
#include "subvol/shells.h"
#include "subvol/surface.h"
#include "subvol/topology.h"
