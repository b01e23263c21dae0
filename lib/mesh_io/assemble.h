// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh_file.h"
#include "subvol/mesh_io.h"

namespace subvol::detail {

/// Makes a mesh of what a reader found. The steps, in this order: drop ghost cells, refuse used points that are not finite,
/// weld points, turn left-handed hexahedra, split other cells into hexahedra, move cell arrays to the points, validate.
///
/// in, file, names: for messages
/// throws: Error(InvalidInput) as `read_mesh`
[[nodiscard]] ReadResult assemble(MeshFile&& found, const TextScanner& in, std::string_view file, const EntityNames& names,
                                  const ReadOptions& options);

}  // namespace subvol::detail
