// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace subvol::cli {

/// The options of `subvol vdb`: how large voxels are, which grids are written, how, and for which frames.
struct VdbArguments {
    RasterizeOptions grids{};
    std::uint64_t budget_bytes = 0;
    std::string like;

    std::vector<std::string> fields, remaps;
    bool clamp = false;
    std::optional<double> prune;  // voxels at most this far from the background are left out
    std::string up = "z";
    double scale = 1;
    bool error = false;
    LevelSetOptions level_set_asked{.name = {}};
    CLI::Option* level_set_option = nullptr;
    std::string from = "mesh";
    int per_edge = 1;

    VdbCompression compression = VdbCompression::Blosc;
    std::size_t memory_bytes = 0;
    bool nano = false;

    std::string frames, to;
    bool velocity = false;
    double frames_per_second = 1;

    void add_sizes_to(CLI::App& app);
    void add_grids_to(CLI::App& app);
    void add_files_to(CLI::App& app);
    void add_frames_to(CLI::App& app);

    /// Nothing if no level set is asked for.
    [[nodiscard]] std::optional<LevelSetOptions> level_set() const;
};

}  // namespace subvol::cli
