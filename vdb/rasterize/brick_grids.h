// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "voxel_bricks.h"

namespace subvol::detail {

enum class GridKind { Float, Vector, Integer };

/// A grid to be made of the channels `channel`, and for vectors the two behind it.
struct GridOfChannels {
    std::string name;
    GridKind kind = GridKind::Float;
    std::size_t channel = 0;
};

/// Hangs the leaves of bricks into the trees of new grids, one for each of `wanted`, and frees them on the way. Leaves that are
/// full of one value become tiles, tiles of one value larger ones.
[[nodiscard]] std::vector<openvdb::GridBase::Ptr> make_grids(VoxelBricks bricks, const std::vector<GridOfChannels>& wanted);

}  // namespace subvol::detail
