// SPDX-License-Identifier: Apache-2.0
#include "sampled_points.h"

#include "grid_input.h"
#include "numbers.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/vdb_sample.h"
#include "subvol/visible_points.h"
#include "text.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

constexpr std::initializer_list<const char*> kOfMeshesOnly{
    "--per-edge",       "--centers", "--scheme",       "--tension", "--levels", "--crease-angle", "--tolerance",  "--footprint",
    "--footprint-size", "--values",  "--value-kernel", "--reduce",  "--refine", "--seconds",      "--color-field"};

/// What --threshold hides; none: nothing.
std::optional<TransferFunction> visible_function(const SampleArguments& arguments,
                                                 const std::optional<TransferFunction>& seen) {
    if (!arguments.threshold.empty()) return opaque_above(parse_number("--threshold", arguments.threshold));
    if (!arguments.drops_invisible()) return std::nullopt;
    if (!seen) throw Error(ErrorCode::InvalidInput, "needs a value, as there is no transfer function", "--threshold");
    return seen;
}

}  // namespace

WithFacts<RbfVolume> sample_reported(HexMesh mesh, const SampleArguments& arguments, const RefineArguments& refinement,
                                     const std::optional<TransferFunction>& seen, Progress* progress) {
    KernelOptions options = arguments.kernel_options(bounds(mesh), refinement.options(0, progress), refinement.levels);
    options.visible = visible_function(arguments, seen);
    return make_mesh_kernels(std::move(mesh), options);
}

WithFacts<RbfVolume> sample_tets_reported(const HexMesh& mesh, const SampleArguments& arguments,
                                          const std::optional<TransferFunction>& seen, Progress* progress) {
    KernelOptions options = arguments.kernel_options(bounds(mesh), {.progress = progress}, {});
    options.visible = visible_function(arguments, seen);
    options.tets = true;
    return make_mesh_kernels(mesh, options);
}

WithFacts<RbfVolume> sample_reported(const VdbGrid& grid, const SampleArguments& arguments,
                                     const std::optional<TransferFunction>& seen, const CLI::App& app, Progress* progress,
                                     BoundaryValues* faces) {
    Facts facts;
    refuse_mesh_options(app, "needs a mesh; this is a grid of voxels");
    refuse_options(app, kOfMeshesOnly, "needs a mesh; this is a grid of voxels");
    const SampleOptions options = arguments.options(box_of(grid.report()), {});
    VoxelSampleResult sampled = facts.timed(progress, "sample", [&] {
        return vdb().sample_rbf_points(grid, {.spacing_world = options.spacing_world,
                                              .correction = options.correction,
                                              .kernel = options.kernel,
                                              .faces = faces != nullptr,
                                              .progress = progress});
    });
    if (faces != nullptr) *faces = std::move(sampled.faces);
    if (grid.report().level_set)
        facts.note(text(grid.report().name, " is a level set: the body within its surface is taken, of density 1"));
    facts["spacing"] = sampled.report.spacing_world;
    facts["voxels_a_side"] = sampled.report.voxels_a_side;
    if (sampled.report.left_out > 0) facts["left_out_voxels"] = sampled.report.left_out;
    RbfVolume volume = std::move(sampled.volume);
    if (const auto visible = visible_function(arguments, seen))
        volume = facts.unpack(visible_kernels(volume, *visible, progress));
    facts["points"] = volume.size();
    return {std::move(volume), std::move(facts)};
}

}  // namespace subvol::cli
