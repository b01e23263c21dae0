// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common_options.h"
#include "report.h"
#include "subvol/vdb_grid.h"

namespace subvol::cli {

/// Whether the input is a `.vdb` file; it may hold points instead.
[[nodiscard]] bool is_vdb_file(const std::string& input);

/// Reads the float grid of a `.vdb` file that --field names, else the first. Puts "input", "field", the voxels' number and size
/// into the report.
///
/// throws: Error(InvalidInput) if it is no `.vdb` file, has no such grid or the grid no active voxels
[[nodiscard]] VdbGrid load_grid(const std::string& input, const CommonOptions& options, Report& report);

/// Where the active voxels lie, with the halves of the outer ones.
[[nodiscard]] Box box_of(const GridReport& grid);

}  // namespace subvol::cli
