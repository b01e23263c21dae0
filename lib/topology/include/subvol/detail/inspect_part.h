// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "subvol/mesh_report.h"

namespace subvol::detail {

/// `inspect` of a part of a mesh: counts what it owns. An edge or a face belongs to the owner of its smallest point.
///
/// part: with all cells at every point that it owns
void add_part(const HexMesh& part, std::span<const std::uint8_t> owned_points, std::span<const std::uint8_t> owned_cells,
              MeshReport& report);

}  // namespace subvol::detail
