// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "mesh_frames.h"
#include "mesh_grids.h"
#include "share.h"
#include "subvol/facts.h"
#include "vdb_output.h"

namespace subvol::cli {

/// The frames that are to be written.
struct FramesToGrids {
    MeshFrames& frames;
    FrameRange all;  ///< the frames of all shares
    Share share;
    std::vector<double> times;  ///< the times of the steps of a series, from step 0; empty: the frames are not steps
};

/// Makes and writes the grids of frames, one after the other. The first frame of all determines the voxel size and the level of
/// all frames.
class FrameWriter {
public:
    /// output: its path has # for the number of the frame
    FrameWriter(MeshGrids& maker, const FramesToGrids& frames, const VdbArguments& asked, VdbOutput output, Progress* progress);

    /// What was found out of the first frame.
    [[nodiscard]] const Facts& facts() const { return facts_; }

    /// returns: the frame as an entry of "frames", and facts of all frames so far
    [[nodiscard]] WithFacts<Facts> write(int frame);

private:
    MeshGrids& maker_;
    FramesToGrids frames_;
    const VdbArguments& asked_;
    VdbOutput output_;
    Progress* progress_;
    Facts facts_;
    HexMesh first_;
    RasterizeOptions options_;
    std::optional<RefinementTables> tables_;
    std::size_t active_voxels_ = 0;
};

}  // namespace subvol::cli
