// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh_file.h"

namespace subvol::detail {

/// Leaves out the cells that VTK's array of ghosts calls duplicates of another piece's, refined elsewhere or hidden, and those
/// with a hidden point; says how many. The array itself goes too.
void drop_ghosts(MeshFile& found);

}  // namespace subvol::detail
