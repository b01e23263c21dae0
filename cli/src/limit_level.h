#pragma once

#include "subvol/hex_mesh.h"
#include "subvol/refine.h"

namespace subvol::cli {

/// A mesh refined until its trilinear cells stand for the limit.
///
/// position_voxels, value_range: how far the last level measured lay from its trilinear cells, as a part of a voxel and of the
///                               field's range
/// converged:                    both are within tolerance; otherwise the cap on levels or cells came first
struct LimitMesh {
    HexMesh mesh;
    int level = 0;
    double position_voxels = 0;
    double value_range = 0;
    bool converged = false;
};

/// Refines until no new point of the next level lies further than .1 voxel from the trilinear middle of its parent's points,
/// and no new value further than 1e-3 of its field's range; at most 4 levels or 8 million cells.
[[nodiscard]] LimitMesh refine_to_limit(HexMesh mesh, RefineOptions options, double voxel_size_world);

}  // namespace subvol::cli
