// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh_file.h"

namespace subvol::detail {

/// VTK's array of ghosts, at the cells or at the points: a sum of bits for each.
inline constexpr std::string_view kGhostArray = "vtkGhostType";
inline constexpr unsigned kDuplicateCell = 1, kRefinedCell = 8, kHiddenCell = 32;
inline constexpr unsigned kHiddenPoint = 2;

/// Leaves out the cells that the array of ghosts marks as duplicates of another piece's cells, as refined or as hidden, and the
/// cells with a hidden point, with a warning that counts them. Removes the array.
void drop_ghosts(MeshFile& found);

}  // namespace subvol::detail
