// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "openvdb_grids.h"

#include <vector>

#include "voxel_bricks.h"

namespace subvol::detail {

enum class GridKind { Float, Vector, Integer };

/// A grid to be made from `channel`; vectors take the next two channels too.
struct GridOfChannels {
    std::string name;
    GridKind kind = GridKind::Float;
    std::size_t channel = 0;
};

/// Makes one grid for each of `wanted` from the leaves of bricks; bricks are freed on the way. Leaves that are full of one
/// value become tiles, and tiles of one value become larger tiles.
[[nodiscard]] std::vector<openvdb::GridBase::Ptr> make_grids(VoxelBricks bricks, const std::vector<GridOfChannels>& wanted);

}  // namespace subvol::detail
