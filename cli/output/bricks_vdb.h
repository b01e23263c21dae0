// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "bricks_input.h"
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

/// Writes NAME_0000.vdb and so on, each with the voxels of a block, and NAME.json that lists them. Together their leaves are
/// those of the whole mesh.
void write_bricks_vdb(const BricksToVoxels& what, const VdbOutput& output, Report& report);

}  // namespace subvol::cli
