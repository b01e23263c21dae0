// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "input.h"
#include "subvol/rbf_volume.h"

namespace subvol::cli {

/// Whether the input is a file of points: .ply, .vtp, or a .vdb with a point grid.
[[nodiscard]] bool holds_points(const std::string& input);

/// Reads them, timed; puts "input" and "points" into the report.
[[nodiscard]] RbfVolume read_points_input(const std::string& input, Report& report);

/// `read_points_input` with nothing but the field that the options select as its first channel, and where it is named a second.
///
/// throws: Error(InvalidInput) if there is no such channel, or if an option of `app` was given that only a mesh can follow
[[nodiscard]] RbfVolume load_points(const std::string& input, const CommonOptions& options,
                                    const std::optional<std::string>& second, const CLI::App& app, Report& report);

/// The range of a channel.
[[nodiscard]] Range channel_range(const RbfVolume& volume, std::size_t channel);

}  // namespace subvol::cli
