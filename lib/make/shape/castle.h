// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Chooses more cells of a mesh, the likeliest first, until the boundary of the chosen ones is a surface at every edge and
/// corner. Cells at the mesh's own hull are left out.
///
/// chosen:   a flag for each cell
/// likeness: a number for each cell
/// fixed:    a flag for each cell that is never added; none: all may be
/// returns:  how many were added
std::size_t make_manifold(const HexMesh& mesh, const std::vector<float>& likeness, std::vector<std::uint8_t>& chosen,
                          std::span<const std::uint8_t> fixed = {});

}  // namespace subvol::detail
