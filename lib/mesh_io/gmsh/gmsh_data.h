// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gmsh_numbers.h"
#include "gmsh_values.h"
#include "mesh_file.h"

namespace subvol::detail {

/// Reads the section $NodeData or $ElementData, whose keyword was the last word, as an array.
///
/// numbers: those of the nodes or of the elements
/// needed:  of each whether it has to have a value; without one the array is left out, and a warning says so
void read_gmsh_data(TextScanner& in, GmshValues& values, bool at_cells, const GmshNumbers& numbers,
                    std::span<const std::uint8_t> needed, MeshFile& found);

}  // namespace subvol::detail
