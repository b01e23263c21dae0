// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "openvdb_grids.h"

namespace subvol::detail {

/// A tree without tiles. left_out: active voxels of the fine tree that no coarse voxel includes
struct CoarseVoxels {
    openvdb::FloatTree::ConstPtr tree;
    std::size_t left_out = 0;
};

/// Means of blocks of n³ voxels: coarse voxel ijk is the mean of the active voxels n·ijk … n·ijk + n−1, active where at least
/// half of these are active.
///
/// n:      1 (the tree itself, without tiles) to 2²⁰
/// throws: Error(InvalidInput) if there are tiles and more than 2³¹ active voxels
[[nodiscard]] CoarseVoxels coarse_voxels(const openvdb::FloatTree::ConstPtr& tree, int n);

}  // namespace subvol::detail
