// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "subvol/mixed_mesh.h"

namespace subvol {

/// Writes a mesh of tetrahedra, octahedra and other cells as VTK XML (.vtu, compressed) with all attributes. VTK has no
/// octahedra: each becomes four tetrahedra around its shortest diagonal.
///
/// throws: Error(InvalidInput) for another extension and as `validate`, Error(Io) if the file cannot be written
void write_mixed_mesh(const std::filesystem::path& path, const MixedMesh& mesh);

}  // namespace subvol
