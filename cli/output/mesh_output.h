// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"
#include "subvol/progress.h"
#include "subvol/shells.h"

namespace subvol::cli {

/// Writes a mesh as `write_mesh`. returns: its warnings
[[nodiscard]] Facts write_reported(const std::string& path, const HexMesh& mesh, const Shells& shells, const MeshSets& sets,
                                   Progress* progress);

/// A mesh without shells, patches and sets.
[[nodiscard]] Facts write_reported(const std::string& path, const HexMesh& mesh, Progress* progress);

}  // namespace subvol::cli
