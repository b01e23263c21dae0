// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/kernel.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"
#include "subvol/sample.h"
#include "subvol/vdb_grid.h"

namespace subvol {

/// spacing_world: distance of the kernels, to the next whole number of voxels; up to a voxel: a kernel for each
/// correction:    from differences between voxels
/// kernel:        radial
struct VoxelSampleOptions {
    double spacing_world = 0;
    Correction correction = Correction::Second;
    Kernel kernel{};
    Progress* progress = nullptr;
};

/// voxels_a_side: of the block that a kernel stands for
/// left_out:      active voxels in blocks of which more than half is inactive
struct VoxelSampleReport {
    std::size_t points = 0;
    int voxels_a_side = 1;
    double spacing_world = 0;
    std::size_t left_out = 0;
};

struct VoxelSampleResult {
    RbfVolume volume;
    VoxelSampleReport report;
};

/// Turns the active voxels of a grid of floats into radial basis functions at their centres, in the order of the grid's leaves.
///
/// With a spacing, blocks of n³ voxels (the first of each a multiple of n) become one kernel with the mean of the active ones;
/// blocks of which less than half is active become none. Gradients are central differences, at the rim one-sided; second
/// derivatives are differences too, 0 where a voxel that they need is inactive. There is no boundary: the volume ends where
/// weights end, which on a flat side is the voxels' own face. The channel has the grid's name, or is `density`.
///
/// throws: Error(InvalidInput) if the transform is not linear, the voxels are no floats, none is active or one is not finite,
///         more than 2³¹ are, the spacing is not finite, or the kernel is not valid or not radial; Error(Cancelled)
/// cost:   80 bytes and 0.2 µs of one core a point; parallel over leaves, the same for any number of threads
[[nodiscard]] VoxelSampleResult sample_rbf_points(const VdbGrid& grid, const VoxelSampleOptions& options = {});

}  // namespace subvol
