// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "subvol/error.h"
#include "subvol/facts.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"

namespace subvol::cli {

/// How grids are written.
struct VdbOutput {
    std::string path;
    VdbCompression compression = VdbCompression::Blosc;
    std::size_t memory_bytes = 0;  // 0: in one piece
    bool nano = false;             // also NAME.nvdb
    std::string level_set{};       // the name of the grid that is one; empty: none is
};

/// Whether a grid has an active voxel.
[[nodiscard]] bool has_voxels(std::span<const VdbGrid> grids);

/// What helps where a volume lies between the voxels' centres, as thin ones may: "try --voxel-size 0.01".
[[nodiscard]] std::string finer_voxels(const MeshSource& source);

/// The error that nothing would be written. hint: what helps
[[nodiscard]] Error no_voxels(const std::string& input, const std::string& hint);

/// A warning and a note on how a mesh in pieces was rasterized, if there is reason.
[[nodiscard]] Facts facts_of(const PartsReport& parts);

/// Rasterizes and writes part by part, in the memory of `output` or of options.block_bytes: what VdbParts says.
///
/// input:   the name of the mesh, for NAME.json
/// prepare: changes the grids of each part before they are written
[[nodiscard]] Facts write_parts(const std::string& input, const MeshSource& source, std::span<const std::string> fields,
                                const RasterizeOptions& options, const VdbOutput& output,
                                const std::function<void(std::vector<VdbGrid>&)>& prepare = {});

/// Writes grids. returns: what is in them
[[nodiscard]] Facts write_reported(std::span<const VdbGrid> grids, const VdbOutput& output, Progress* progress);

/// Writes the grids of a share, which may be empty. returns: what is in them
[[nodiscard]] Facts write_share(std::span<const VdbGrid> grids, const VdbOutput& output, Progress* progress);

/// Writes the grids of one frame.
///
/// returns: the frame as an entry of "frames"; its facts are the seconds
[[nodiscard]] WithFacts<Facts> write_frame(int frame, std::span<const VdbGrid> grids, const VdbOutput& output,
                                           Progress* progress);

}  // namespace subvol::cli
