// SPDX-License-Identifier: Apache-2.0
#pragma once

/// What the limit of a mesh is asked for. Each answer comes with what is known of its error, and beside it with the figure of
/// the cells as they were given.
///
/// - `field_of`: a quantity, such as "mises(S)" or "grad(T).x", as a field; `Region`: some of the cells, or a part of space.
/// - `LimitProbe`, `LimitField`: values and gradients at places of the world.
/// - `measure_limit`, `measure_patches`: volumes, integrals, means, flows, extremes with their places; of all, of parts or
///   patches.
/// - `LimitSlice`: values on a plane; `SliceFigures`: their area, mean and extremes (`measure.h`). `Streamlines`.
/// - `limit_surface`: isosurfaces and the boundary as triangles; `part_of_limit`: some cells as a mesh of their own.
///
/// Rooms: `quantity` (expressions and regions; functions of tensors are a table in `tensor_functions.cpp`), `extract` (what
/// the limit is at places), `measure` (integrals and extremes, those of slices too), `surface` (triangles).
///
///     HexMesh ── field_of ──► field ─┬─► probe_limit        at places
///        │                           ├─► measure_limit      over the volume, GivenFigures: of the cells as given
///        └── Region ── cells_in ─────┼─► measure_patches    over its boundary
///                                    ├─► slice_limit        on a plane
///                                    └─► limit_surface      at a value

#include "subvol/limit_field.h"
#include "subvol/limit_shells.h"
#include "subvol/limit_sides.h"
#include "subvol/limit_slice.h"
#include "subvol/limit_surface.h"
#include "subvol/measure.h"
#include "subvol/mixed_file.h"
#include "subvol/mixed_probe.h"
#include "subvol/part_of_limit.h"
#include "subvol/part_opacity.h"
#include "subvol/part_places.h"
#include "subvol/patch_measure.h"
#include "subvol/points_error.h"
#include "subvol/probe.h"
#include "subvol/quantity.h"
#include "subvol/region.h"
#include "subvol/stream_surface.h"
#include "subvol/streamlines.h"
#include "subvol/warp.h"
