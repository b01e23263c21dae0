// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/camera.h"
#include "subvol/hex_mesh.h"
#include "subvol/optics.h"
#include "subvol/study_run.h"
#include "subvol/vdb_grid.h"

namespace subvol::cli {

/// The mesh of a case with its one attribute: a model or a file, refined as often as it says, its density taken anew.
///
/// "density": an expression in x, y, z, or "smooth": ½(sin 3x cos 2y + z) on a box of about [-1,1]³ about the mesh, so that all
/// meshes are alike in it
[[nodiscard]] HexMesh study_mesh(const StudyCase& of);

/// The limit of the mesh as voxels, at the resolution of the case; result: gets the voxels' metrics.
[[nodiscard]] VdbGrid study_grid(const StudyCase& of, const HexMesh& mesh, CaseResult& result);

[[nodiscard]] Optics study_optics(const StudyCase& of, const HexMesh& mesh);

/// A side is fitted to the mesh's box, or to what can be seen of it.
[[nodiscard]] View study_view(const StudyCase& of, const HexMesh& mesh, const Optics& optics);

}  // namespace subvol::cli
