// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/boundary_values.h"
#include "subvol/kernel.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"
#include "subvol/sample.h"
#include "subvol/vdb_grid.h"

namespace subvol {

struct VoxelSampleOptions {
    /// Distance of the kernels, rounded to a whole number of voxels; up to one voxel, each voxel becomes a kernel.
    double spacing_world = 0;
    /// Its derivatives are differences between voxels; the body of a level set has none.
    Correction correction = Correction::Second;
    Kernel kernel{};     ///< must be radial
    bool faces = false;  ///< whether the faces of the blocks are wanted, too; a level set has its surface
    Progress* progress = nullptr;
};

struct VoxelSampleReport {
    std::size_t points = 0;
    int voxels_a_side = 1;  ///< side of the block that becomes a kernel, in voxels
    double spacing_world = 0;
    std::size_t left_out = 0;  ///< active voxels in blocks of which more than half is inactive
};

struct VoxelSampleResult {
    RbfVolume volume;
    VoxelSampleReport report;
    BoundaryValues
        faces{};  ///< between blocks that are kernels and those that are none, with the channel's values; if asked for
};

/// Turns the active voxels of a grid of floats into radial basis functions at their centres, in the order of the grid's leaves.
///
/// With a spacing, a block of n³ voxels (aligned at multiples of n) becomes one kernel with the mean of its active voxels, or
/// none if less than half of them are active. Gradients are central differences, one-sided at the rim; second derivatives are
/// differences too, 0 where a voxel that they need is inactive. The result has no boundary surface: the volume ends where the
/// kernels' weights end, which on a flat side is the voxels' own face. The channel has the grid's name, or `density`.
///
/// A level set gives the body within its surface: density 1, at kernels in the middle of blocks of voxels that the inside
/// reaches, and with the surface as the boundary. Without a spacing there are up to 64 blocks along the longest side.
///
/// throws: Error(InvalidInput) if the transform is not linear, the voxels are not floats, no voxel is active, more than 2³¹
/// are, a
///         value is not finite, the spacing is not finite, or the kernel is not valid or not radial; Error(Cancelled)
/// cost:   80 bytes and 0.2 µs of one core per point; parallel over leaves, the same for any number of threads
[[nodiscard]] VoxelSampleResult sample_rbf_points(const VdbGrid& grid, const VoxelSampleOptions& options = {});

}  // namespace subvol
