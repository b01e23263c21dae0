// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mesh_frames.h"
#include "mesh_grids.h"
#include "share.h"
#include "vdb_output.h"

namespace subvol::cli {

/// The frames that are to be written.
///
/// all:   of all shares
/// times: of the steps of a series, from step 0; empty: the frames are no steps
struct FramesToGrids {
    MeshFrames& frames;
    FrameRange all;
    Share share;
    std::vector<double> times;
};

/// Makes and writes the grids of each frame of a share. The first frame of all determines the voxel size and the level of all
/// frames.
///
/// into: its path has # for the number of the frame
void write_frames(MeshGrids& maker, const FramesToGrids& what, const VdbArguments& asked, const VdbOutput& into,
                  Report& report);

}  // namespace subvol::cli
