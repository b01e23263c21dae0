// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh_file.h"
#include "subvol/mesh_io.h"

namespace subvol::detail {

/// Makes a mesh of what a reader found. The steps, in this order: drop ghost cells, refuse used points that are not finite,
/// weld points, turn left-handed hexahedra, split other cells into hexahedra, move cell arrays to the points, validate, tag
/// sharp faces and creases.
///
/// in, file, names: for messages
/// throws: Error(InvalidInput) as `read_mesh`
[[nodiscard]] ReadResult assemble(MeshFile&& found, const TextScanner& in, std::string_view file, const EntityNames& names,
                                  const ReadOptions& options);

/// VTK's array of ghosts, at the cells or at the points: a sum of bits for each.
inline constexpr std::string_view kGhostArray = "vtkGhostType";
inline constexpr unsigned kDuplicateCell = 1, kRefinedCell = 8, kHiddenCell = 32;
inline constexpr unsigned kHiddenPoint = 2;

/// Leaves out the cells that the array of ghosts marks as duplicates of another piece's cells, as refined or as hidden, and the
/// cells with a hidden point, with a warning that counts them. Removes the array.
void drop_ghosts(MeshFile& found);

/// Joins points at the same place: cells then use the first of them. Adds a warning that counts the points.
///
/// tolerance: a point is joined to the first one before it that is no farther away; world units, 0: at exactly the same place
/// throws:    Error(InvalidInput) if a cell would then have the same corner twice
/// cost:      O(n) if few points lie within a tolerance of each other
void weld_points(MeshFile& found, double tolerance, std::string_view file, const EntityNames& names);

}  // namespace subvol::detail
