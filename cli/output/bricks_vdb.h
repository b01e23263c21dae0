// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "bricks_input.h"
#include "share.h"
#include "subvol/rasterize.h"
#include "vdb_output.h"

namespace subvol::cli {

/// A mesh in bricks that is to be rasterized.
///
/// options: with a voxel size, or `like`; limit: the limit, not the mesh of options.refine
struct BricksToVoxels {
    const Bricks& bricks;
    std::vector<StreamedField> fields;
    RasterizeOptions options;
    bool limit = true;
};

/// The grids of a slab of whole leaves across x, which is one share; slabs take about equal memory. Only the bricks that touch
/// it are read. The grids of a slab without voxels are empty.
///
/// memory_bytes: about the most that a block of voxels and the cells about it take; 0: 1 GB
[[nodiscard]] WithFacts<std::vector<VdbGrid>> grids_of_bricks(const BricksToVoxels& what, std::size_t memory_bytes,
                                                              const Share& share);

/// Writes NAME.vdb, or where the grids do not fit into the memory (1 GB unless `output` says another) parts, each with the
/// voxels of a block, and NAME.json that lists them. Together their leaves are those of the whole mesh.
///
/// input: the folder, for NAME.json and errors
[[nodiscard]] Facts write_bricks_vdb(const std::string& input, const BricksToVoxels& what, const VdbOutput& output);

}  // namespace subvol::cli
