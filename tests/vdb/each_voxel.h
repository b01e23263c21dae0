// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/vdb_grid.h"

namespace subvol::test {

/// Calls visit(voxel, value) for the active voxels of a grid of floats.
template <class Visit>
void for_each_voxel(const VdbGrid& grid, const Visit& visit) {
    const auto voxels = grid.voxels();
    const auto cursor = voxels->cursor();
    const auto [lower, upper] = voxels->range();
    for (int x = lower[0]; x <= upper[0]; ++x) {
        for (int y = lower[1]; y <= upper[1]; ++y) {
            for (int z = lower[2]; z <= upper[2]; ++z) {
                const VoxelCorners corners = cursor->corners({x, y, z});
                // Inactive voxels inside a level set have the background, below zero, as their value.
                const double outside = grid.report().outside;
                const bool filled = outside > 0 && corners.values[0] <= -outside;
                if ((corners.active & 1) != 0 && !filled) visit(Voxel{x, y, z}, corners.values[0]);
            }
        }
    }
}

}  // namespace subvol::test
