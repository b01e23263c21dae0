// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "subvol/probe.h"

namespace subvol {

/// Leaves of the places that were found in the limit of a mesh those in some of its cells; the others become places outside. A
/// place where cells meet is in the part if one of these cells is, and then has that cell.
///
/// found: places in cells of this mesh
/// cells: a flag for each cell of the mesh
void keep_places_in(const HexMesh& mesh, std::span<const std::uint8_t> cells, ProbeResult& found);

}  // namespace subvol
