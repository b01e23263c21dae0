#pragma once

#include <vector>

#include "report.h"
#include "subvol/vdb.h"

namespace subvol::cli {

/// Grids of a mesh whose fields are those of kernels sampled from it, summed at the voxels of the mesh. Puts the points'
/// number, and how far the sums are from the mesh's own values, into the report.
///
/// throws: Error(InvalidInput) as `rasterize`, or if a field has three components
[[nodiscard]] std::vector<VdbGrid> kernel_sums(const HexMesh& mesh, const RasterizeOptions& options, int per_edge,
                                               Report& report);

}  // namespace subvol::cli
