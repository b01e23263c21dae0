// SPDX-License-Identifier: Apache-2.0
#pragma once

/// All of subvol::io: everything that knows a file format of a mesh.
///
/// - `read_mesh`, `write_mesh`: any format, by its name or its first bytes; `ReadResult`: the mesh, its sets, its fields.
/// - `open_series`: steps in time. `mesh_of_vtk`, `VtkUnstructuredGrid`: meshes to and from VTK in memory.
/// - `read_foreign_files`: files of other programs, by a converter that a program runs.
/// - `split_mesh`, `open_bricks`: meshes in folders of bricks, worked on brick by brick.
/// - `read_labels`: voxels with labels, of `.vti` and `.nrrd`.
/// - `write_wavelet_file`, `write_series_file`: fine meshes and series in few bytes.
///
/// Rooms, each with its own `include`: `mesh_file` (what a file holds, and the mesh that is assembled from it), `mesh_io` and
/// `solver_io` (a folder for the reader of each family; a format is a row in the table of `mesh_io.cpp`: its extensions, its
/// first bytes, its reader, its writer), `wavelet`, `series`, `bricks`, `labels`.
///
///     file ── reader of its format ──► MeshFile ── assemble: weld, split, tag ──► HexMesh + MeshSets + FieldInfo
///     HexMesh ──► .vtk, .vtu, .vtkhdf, .mesh, .svw; bricks

#include "subvol/brick_points.h"
#include "subvol/bricks.h"
#include "subvol/coarse_edit.h"
#include "subvol/foreign_files.h"
#include "subvol/hierarchy.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_series.h"
#include "subvol/read_labels.h"
#include "subvol/read_options.h"
#include "subvol/series_file.h"
#include "subvol/split.h"
#include "subvol/vtk_grid.h"
#include "subvol/wavelet.h"
#include "subvol/wavelet_file.h"
