// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/vdb_grid.h"

namespace subvol::cli {

/// The name of the grid of velocities, as renderers know it.
inline constexpr const char* kVelocity = "vel";

/// Adds a velocity to the fields of a mesh.
///
/// factor: the values are multiplied with it
/// throws: Error(InvalidInput) if the mesh has a field of its name
void add_velocity(Attribute velocity, HexMesh& mesh, double factor);

/// Extends the velocities beyond the volume, to where it is at other times while a shutter is open.
///
/// grids: one of them may be that of velocities
/// frame: for messages
[[nodiscard]] Facts spread_velocity(int frame, double frames_per_second, std::vector<VdbGrid>& grids, Progress* progress);

}  // namespace subvol::cli
