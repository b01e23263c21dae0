// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "subvol/rasterize.h"

namespace subvol::detail {

/// Cubes of 32³ voxels, which are whole leaves: from `lower` to before `upper` along each axis; cube i begins at voxel 32·i.
struct VoxelCubes {
    static constexpr int kSide = 32;
    std::array<int, 3> lower{}, upper{};
};

struct BlockGrids {
    std::vector<VdbGrid> grids;  ///< the voxels in the block
    /// Cells fold over, and what they fill beyond the boundary was looked for along z in the part that was given.
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

/// `rasterize_parts` and `rasterize_share` of a mesh in pieces.
PartsReport rasterize_blocks(const MeshSource& source, std::span<const std::string> fields, const RasterizeOptions& options,
                             double memory_bytes, const std::function<void(GridPart)>& take);
[[nodiscard]] GridShare rasterize_share_of_pieces(const MeshSource& source, std::span<const std::string> fields,
                                                  const RasterizeOptions& options, const Share& share);

}  // namespace subvol::detail
