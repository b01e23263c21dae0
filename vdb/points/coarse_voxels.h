// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>

namespace subvol::detail {

/// A tree without tiles. left_out: active voxels that count in none of its own
struct CoarseVoxels {
    openvdb::FloatTree::ConstPtr tree;
    std::size_t left_out = 0;
};

/// Means of blocks of n³ voxels, those of the block n·ijk … n·ijk + n−1 at ijk; active where at least half of the block is.
///
/// n: 1 (the tree as it is, but for tiles) to 2²⁰
/// throws: Error(InvalidInput) if there are tiles and more than 2³¹ active voxels
[[nodiscard]] CoarseVoxels coarse_voxels(const openvdb::FloatTree::ConstPtr& tree, int n);

}  // namespace subvol::detail
