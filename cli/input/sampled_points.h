// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_arguments.h"
#include "subvol/facts.h"
#include "subvol/transfer_function.h"
#include "subvol/vdb_grid.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// Samples the limit of the mesh, or with --levels the refined mesh as it is, and drops what --threshold makes invisible; timed
/// and with its points in the facts.
///
/// seen: the transfer function of the first field; none: --threshold needs a value
[[nodiscard]] WithFacts<RbfVolume> sample_reported(HexMesh mesh, const SampleArguments& arguments,
                                                   const RefineArguments& refinement,
                                                   const std::optional<TransferFunction>& seen, Progress* progress);

/// One kernel at each point of a mesh of tetrahedra on its limit, which TetRefinement made hexahedra of.
///
/// throws: Error(InvalidInput) for options that place kernels otherwise
[[nodiscard]] WithFacts<RbfVolume> sample_tets_reported(const HexMesh& mesh, const SampleArguments& arguments,
                                                        const std::optional<TransferFunction>& seen, Progress* progress);

/// The same of a grid's voxels.
///
/// app:   the verb's; its options that apply to meshes only are refused
/// faces: gets the faces of the voxels of a grid that is no level set; null: they are not wanted
[[nodiscard]] WithFacts<RbfVolume> sample_reported(const VdbGrid& grid, const SampleArguments& arguments,
                                                   const std::optional<TransferFunction>& seen, const CLI::App& app,
                                                   Progress* progress, BoundaryValues* faces = nullptr);

}  // namespace subvol::cli
