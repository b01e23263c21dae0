// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The heart: the rules by which a control mesh is refined, and the limit that the levels approach.
///
/// - `Scheme`, `SchemeOptions`: MCQ (interpolating), Catmull-Clark solids, BSXW, linear.
/// - `refine`: the next levels of a mesh, or of some of its cells; `StencilTable`: the same as weights, for any fields.
/// - `evaluate_limit`: positions, values and derivatives at parameters of cells, without a level.
/// - `LimitCells`: curved pieces within a tolerance of the limit; what voxels, measures and pictures are made of.
/// - `check_folds`, `mend_folds`: a proof that the limit of a cell does not fold, or a place where it does.
/// - `MixedMesh`: the same for tetrahedra, octahedra, prisms and pyramids.
///
/// Rooms: `scheme` (a row of weights for each new point; Catmull-Clark and BSXW share `SplineScheme`, which has their
/// creases), `refine` (levels), `classes` (cells whose neighbourhoods are alike, and their tables), `limit`, `mixed`,
/// `certificate` (folds).
///
///     HexMesh ──► refine ──► level 1, 2, … ─ ─ ─► limit
///        │                                          ▲
///        ├── classes of cells that meet alike, and their tables of weights
///        └── evaluate_limit, find_limit_cells, on_limit ──► places, pieces and points of the limit
///
/// The formulas are in docs/schemes.md and docs/science.md.

#include "subvol/boundary_values.h"
#include "subvol/certificate.h"
#include "subvol/dense_cells.h"
#include "subvol/field_samples.h"
#include "subvol/limit.h"
#include "subvol/limit_body.h"
#include "subvol/limit_level.h"
#include "subvol/mend_folds.h"
#include "subvol/mixed_mesh.h"
#include "subvol/refine.h"
#include "subvol/refine_mixed.h"
#include "subvol/refine_shells.h"
#include "subvol/scheme.h"
#include "subvol/stencil_table.h"
