// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "subvol/rasterize.h"

namespace subvol {

/// Cubes of 32³ voxels, which are whole leaves: from `lower` to before `upper` along each axis; cube i begins at voxel 32·i.
struct VoxelCubes {
    static constexpr int kSide = 32;
    std::array<int, 3> lower{}, upper{};
};

/// grids:  the voxels in the block
/// folded: cells fold over, and what they fill beyond the boundary was looked for along z in the part that was given
struct BlockGrids {
    std::vector<VdbGrid> grids;
    bool folded = false;
};

/// Rasterizes the voxels of a block from a part of a mesh: its leaves are those that `rasterize` makes of the whole mesh. If
/// `folded`, they are only if the part has all cells above and below the block.
///
/// part:    all cells whose limit touches the block, with a halo of three layers, in the order of the whole mesh
/// options: as for `rasterize`, with a voxel size, or `like`; without cell numbers, coverage and a level set
/// throws:  as `rasterize`; the limits of voxels hold for the part
[[nodiscard]] BlockGrids rasterize_block(const HexMesh& part, std::span<const std::string> fields,
                                         const RasterizeOptions& options, const VoxelCubes& block);

}  // namespace subvol
