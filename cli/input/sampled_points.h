// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report.h"
#include "sample_arguments.h"
#include "subvol/transfer_function.h"
#include "subvol/vdb_grid.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// Samples the limit of the mesh, or with --levels the refined mesh as it is, and drops what --threshold makes invisible; timed
/// and with its points in the report.
///
/// seen: the transfer function of the first field; none: --threshold needs a value
[[nodiscard]] RbfVolume sample_reported(HexMesh mesh, const SampleArguments& arguments, const RefineArguments& refinement,
                                        const std::optional<TransferFunction>& seen, Report& report);

/// One kernel at each point of a mesh of tetrahedra on its limit, which TetRefinement made hexahedra of.
///
/// throws: Error(InvalidInput) for options that place kernels otherwise
[[nodiscard]] RbfVolume sample_tets_reported(const HexMesh& mesh, const SampleArguments& arguments,
                                             const std::optional<TransferFunction>& seen, Report& report);

/// throws: Error(InvalidInput) for options that place kernels elsewhere than at the points of a level of tetrahedra
void refuse_other_places(const SampleArguments& arguments, const SampleOptions& options);

/// The same of a grid's voxels.
///
/// app: the verb's; its options that apply to meshes only are refused
[[nodiscard]] RbfVolume sample_reported(const VdbGrid& grid, const SampleArguments& arguments,
                                        const std::optional<TransferFunction>& seen, const CLI::App& app, Report& report);

}  // namespace subvol::cli
