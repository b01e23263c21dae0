// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/index.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// The ids of points in the order of a Morton curve through their box, equal keys by id. Points that are near each other in
/// this order are near each other in space, so that their data share cache lines.
[[nodiscard]] std::vector<Index> space_order(std::span<const Vec3> points);

/// Some cells of a mesh in the order of their middles: a run of them has few others around it.
[[nodiscard]] std::vector<Index> in_space_order(const HexMesh& mesh, std::span<const Index> cells);

}  // namespace subvol::detail
