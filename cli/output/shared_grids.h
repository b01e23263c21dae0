// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "part_note.h"
#include "ranks.h"
#include "report.h"
#include "subvol/vdb_grid.h"
#include "vdb_output.h"

namespace subvol::cli {

/// The grids of all ranks at rank 0, joined, to be written. Without ranks those of the share are written here. Nothing
/// elsewhere.
///
/// own:   of a share of the voxels
/// ranks: null: this process alone makes the share
/// note:  of the share's file
/// half:  whether the joined grids are rounded to 16 bits; shares are not, as whoever has all voxels rounds them
[[nodiscard]] std::vector<VdbGrid> of_all_shares(std::vector<VdbGrid> own, Ranks* ranks, const PartNote& note, bool half,
                                                 const VdbOutput& output, Report& report);

}  // namespace subvol::cli
