// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// Returns the bounding box of each body of a mesh, in the order of their first points: cells that share a point are of one
/// body.
///
/// cost: linear, 4 bytes a point
[[nodiscard]] std::vector<Box> boxes_of_bodies(const HexMesh& mesh);

}  // namespace subvol::detail
