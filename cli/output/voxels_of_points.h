// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common_options.h"
#include "subvol/facts.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// Grids of a mesh whose values are the sums of kernels sampled from it, at the voxels of the mesh. Facts are the number of
/// points, and the difference of the sums from the mesh's values.
///
/// throws: Error(InvalidInput) as `rasterize`, or if a field has three components
[[nodiscard]] WithFacts<std::vector<VdbGrid>> kernel_sums(const HexMesh& mesh, const RasterizeOptions& options, int per_edge);

/// Grids of a file of points, made of the fields named, else of the one that the options select, else of the first.
///
/// app:    the verb's; its options that apply to meshes only are refused
/// throws: Error(InvalidInput) as `rasterize_points`, or if a field is not there
[[nodiscard]] WithFacts<std::vector<VdbGrid>> grids_of_points(const std::string& input, std::vector<std::string> fields,
                                                              const CommonOptions& common, const CLI::App& app,
                                                              const RasterizeOptions& options);

}  // namespace subvol::cli
