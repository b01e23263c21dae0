// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common_options.h"
#include "subvol/facts.h"
#include "subvol/vdb_contents.h"
#include "subvol/vdb_grid.h"

namespace subvol::cli {

/// A file's extension in small letters, with the dot.
[[nodiscard]] std::string extension_of(const std::string& file);

/// Whether the input is a `.vdb` file, also if that is written in capitals; it may contain points instead of grids.
[[nodiscard]] bool is_vdb_file(const std::string& input);

/// The grid of floats that a name means: one of the file's, of a grid of vectors the lengths, or with NAME.x (or NAME.0) a
/// component. Without a name the first grid of floats, else the first of vectors.
///
/// input:  the file, named in the error
/// throws: Error(InvalidInput) if there is no such grid
[[nodiscard]] VdbGrid select_grid(const VdbContents& contents, const std::optional<std::string>& name,
                                  const std::string& input);

/// Reads the grid of a `.vdb` file that --field names, as `select_grid` does. Facts: "field", and the number
/// and size of the voxels.
///
/// throws: Error(InvalidInput) if it is not a `.vdb` file, has no such grid, or the grid has no active voxels
[[nodiscard]] WithFacts<VdbGrid> load_grid(const std::string& input, const CommonOptions& options, Progress* progress);

/// The same for a grid of floats or of labels: a grid of integers stays one. Without --field it is the first grid of floats,
/// else of vectors, else of integers.
///
/// labels: only grids of integers
[[nodiscard]] WithFacts<VdbGrid> load_grid_or_labels(const std::string& input, const CommonOptions& options, bool labels,
                                                     Progress* progress);

/// The box of the active voxels: that of their centres, and half a voxel more to all sides.
[[nodiscard]] Box box_of(const GridReport& grid);

}  // namespace subvol::cli
