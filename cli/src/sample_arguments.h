#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "refine_arguments.h"
#include "subvol/sample.h"

namespace subvol::cli {

/// How a mesh becomes radial basis functions, as `points` and `render --method splat` ask for it.
struct SampleArguments {
    int per_edge = 1;
    double spacing_world = 0;
    double spacing_voxels = 0;
    std::string correction = "second";
    double reduce_rmse = 0;  // > 0: as few kernels as this error needs, instead of samples at a spacing
    bool move_kernels = false;

    void add_to(CLI::App& app);

    /// throws: Error(InvalidInput) if a name is unknown
    [[nodiscard]] SampleOptions options(const Box& box, const RefineOptions& refinement) const;
};

/// Samples the limit of the mesh, or with --levels the refined mesh as it is; timed and with its points in the report.
[[nodiscard]] RbfVolume sample_reported(const HexMesh& mesh, const SampleArguments& arguments,
                                        const RefineArguments& refinement, Report& report);

}  // namespace subvol::cli
