// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "input.h"
#include "subvol/kernel_file.h"
#include "subvol/rbf_volume.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// Whether the input is a file of points: .ply, .vtp, .svk, or a .vdb with a point grid.
[[nodiscard]] bool holds_points(const std::string& input);

/// Reads them, timed; "points" is a fact.
[[nodiscard]] WithFacts<RbfVolume> read_points_input(const std::string& input, Progress* progress);

/// `read_points_input` with all fields.
///
/// throws: Error(InvalidInput) if an option of `app` was given that applies to meshes only
[[nodiscard]] WithFacts<RbfVolume> load_all_points(const std::string& input, const CLI::App& app, Progress* progress);

/// `read_points_input` with only the field that the options select, and with the field `second` if that is given.
///
/// throws: Error(InvalidInput) if there is no such channel, or if an option of `app` was given that applies to meshes only
[[nodiscard]] WithFacts<RbfVolume> load_points(const std::string& input, const CommonOptions& options,
                                               const std::optional<std::string>& second, const CLI::App& app,
                                               Progress* progress);

/// Whether the input is a file of points with levels of detail, .svk.
[[nodiscard]] bool holds_levels(const std::string& input);

/// A file of points with levels of detail that was opened.
struct LevelsInput {
    KernelFile file;
    std::vector<std::size_t> channels;  ///< the channels of the fields that `load_points` selects
};

/// Opens such a file in place of `load_points`. cache_bytes: as of KernelFile
[[nodiscard]] WithFacts<LevelsInput> open_levels(const std::string& input, const CommonOptions& options,
                                                 const std::optional<std::string>& second, std::uint64_t cache_bytes,
                                                 const CLI::App& app, Progress* progress);

/// The number of the channel with this name.
///
/// input:  the file, named in the error
/// throws: Error(InvalidInput) if there is none
[[nodiscard]] std::size_t find_channel(const RbfVolume& volume, const std::string& name, const std::string& input);

/// The range of a channel.
[[nodiscard]] Range channel_range(const RbfVolume& volume, std::size_t channel);

}  // namespace subvol::cli
