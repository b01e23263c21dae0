// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/camera.h"
#include "subvol/hex_mesh.h"
#include "subvol/optics.h"
#include "subvol/study_run.h"
#include "subvol/vdb_grid.h"

namespace subvol::cli {

/// The mesh of a case with its one attribute: a model or a file, refined as the case says; the density is computed after that.
///
/// "density": an expression in x, y, z, or "smooth": ½(sin 3x cos 2y + z) on a box of about [-1,1]³ around the mesh, so that
/// meshes of different size have similar densities
[[nodiscard]] HexMesh study_mesh(const StudyCase& item);

/// The limit of the mesh as voxels, at the resolution of the case.
///
/// result: gets the metrics of the voxels
[[nodiscard]] VdbGrid study_grid(const StudyCase& item, const HexMesh& mesh, CaseResult& result);

[[nodiscard]] Optics study_optics(const StudyCase& item, const HexMesh& mesh);

/// The camera of a case; a side view is fitted to the mesh's box, or to its visible part.
[[nodiscard]] View study_view(const StudyCase& item, const HexMesh& mesh, const Optics& optics);

}  // namespace subvol::cli
