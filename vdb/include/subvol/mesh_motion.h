#pragma once

#include <string>

#include "subvol/hex_mesh.h"
#include "subvol/vdb.h"

namespace subvol {

/// Whether cells, creases and sharp faces are the same: nothing of a refinement differs but points and values.
[[nodiscard]] bool same_cells(const HexMesh& a, const HexMesh& b);

/// How the points move from one mesh to another of the same cells: their differences over the time between the two, world units
/// a unit of `time`. At the middle of that time this is of second order. As refinement is linear, the refined attribute is the
/// velocity of the refined points.
///
/// returns: three channels
/// throws:  Error(InvalidInput) if the cells differ or the time is not positive
[[nodiscard]] Attribute velocity_between(const HexMesh& before, const HexMesh& after, double time,
                                         const std::string& name = "vel");

/// A grid of vectors that reaches so many voxels further, to all sides: layer by layer, each new voxel has the mean of the
/// voxels about it that were there before.
///
/// Renderers that blur what moves ask for the velocity where the volume may have been, which is outside it.
/// layers: 0 to 1000
/// throws: Error(InvalidInput) if the voxels are no vectors of floats, or of so many layers
/// cost:   some 2 µs of one core a new voxel, parallel; the same for any number of threads. Memory: the new grid and its mask
[[nodiscard]] VdbGrid spread_vectors(const VdbGrid& grid, int layers);

}  // namespace subvol
