// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Control meshes and their fields, made so that the limit is near to something else.
///
/// - `fit_cell_means`: values at points whose limit has given means over the cells, as finite volumes have them.
/// - `approximate`, `Approximator`: fields of a mesh near to samples, another mesh, points or a grid, by least squares.
/// - `control_mesh_of`: hexahedra that fill closed surfaces, each a material.
/// - `fit_shape`: a mesh whose boundary lies near to a surface, without folds.
/// - `LabelGrid`, `label_surfaces`: voxels with labels, such as scans, and the surface of each label for `control_mesh_of`.
/// - `read_surface`: closed surfaces of `.stl`, `.obj`, `.ply` and `.glb`; which names are surfaces, the wing files says.
///
/// Rooms: `means`, `approximate`, `shape` (surfaces: read, filled, fitted to), `labels`.
///
///     means over cells ──► fit_cell_means ──► field
///     samples ──► approximate ──► field ── errors at the samples, and between them
///     labels ──► label_surfaces ──► surfaces
///     surface ──► control_mesh_of ──► HexMesh ──► fit_shape ──► HexMesh ── distances both ways, folds

#include "subvol/approximate.h"
#include "subvol/approximator.h"
#include "subvol/cell_means.h"
#include "subvol/control_mesh.h"
#include "subvol/fit_shape.h"
#include "subvol/label_grid.h"
#include "subvol/read_surface.h"
