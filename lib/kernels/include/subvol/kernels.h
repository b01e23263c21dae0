// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Volumes as sums of kernels at points.
///
/// - `Kernel`: a radial or separable function of a distance; formulas, integrals along a ray, JSON, GLSL.
/// - `RbfVolume`: kernels at points, each with a frame and values of its channels; `RbfField`: its value at any place.
/// - `sample_rbf_points`: kernels for the vertices, edges, faces and cells of a mesh's limit.
/// - `fit_kernel`: the kernel nearest to a scheme's basis function, which replaces deep refinement.
/// - `reduce_rbf`: as few kernels as an error needs.
/// - `KernelHierarchy`: a tree of kernels, and the cut through it for a view; `KernelFile`: the same on disk.
///
/// Rooms: `kernel`, `points` (a volume as kernels, and its field), `fit`, `sample` (from meshes), `reduce`, `points_io`
/// (`.ply`, `.vtp`, `.svk`, OpenUSD), `lod` (hierarchies).
///
///     Scheme ──► basis function ──► fit_kernel ──► Kernel
///     HexMesh ── limit at its entities ──► sample_rbf_points ──► RbfVolume ──► pictures, .vdb, .ply, .vtp, .svk, OpenUSD
///                                                                   └──► build_kernel_hierarchy ──► choose_cut

#include "subvol/basis_function.h"
#include "subvol/clamp_channel.h"
#include "subvol/fit_kernel.h"
#include "subvol/kernel.h"
#include "subvol/kernel_file.h"
#include "subvol/kernel_hierarchy.h"
#include "subvol/mesh_kernels.h"
#include "subvol/points_io.h"
#include "subvol/rbf_field.h"
#include "subvol/rbf_volume.h"
#include "subvol/reduce.h"
#include "subvol/sample.h"
#include "subvol/sample_mixed.h"
#include "subvol/sample_pieces.h"
#include "subvol/sample_tables.h"
#include "subvol/usd_file.h"
#include "subvol/visible_points.h"
