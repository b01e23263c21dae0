// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

namespace subvol::cli {

/// What `info` says to people about a mesh: a line for each figure, with units, and at the end whether the mesh is sound.
///
/// seconds: of each stage, as in the report
[[nodiscard]] std::string mesh_lines(const ReadResult& read, const MeshReport& mesh, const Json& seconds);

/// "sound", or what is wrong, as "51 cells inverted: 3, 17, 20, …".
[[nodiscard]] std::string verdict(const HexMesh& mesh, const MeshReport& report);

}  // namespace subvol::cli
