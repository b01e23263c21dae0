// SPDX-License-Identifier: Apache-2.0
#include "sampled_points.h"

#include "grid_input.h"
#include "numbers.h"
#include "subvol/error.h"
#include "subvol/reduce.h"
#include "subvol/sample_mixed.h"
#include "subvol/vdb_sample.h"
#include "subvol/visible_points.h"
#include "text.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

constexpr std::initializer_list<const char*> kOfMeshesOnly{
    "--per-edge",       "--centers", "--scheme",       "--tension", "--levels", "--crease-angle", "--tolerance",  "--footprint",
    "--footprint-size", "--values",  "--value-kernel", "--reduce",  "--refine", "--seconds",      "--color-field"};

/// The volume, with --threshold without the kernels that nobody sees. facts: become those of the result
WithFacts<RbfVolume> without_invisible(RbfVolume volume, const SampleArguments& arguments,
                                       const std::optional<TransferFunction>& seen, Progress* progress, Facts facts) {
    if (!arguments.drops_invisible()) {
        facts["points"] = volume.size();
        return {std::move(volume), std::move(facts)};
    }
    if (arguments.threshold.empty() && !seen) {
        throw Error(ErrorCode::InvalidInput, "needs a value, as there is no transfer function", "--threshold");
    }
    const TransferFunction function =
        arguments.threshold.empty() ? *seen : opaque_above(parse_number("--threshold", arguments.threshold));
    VisibleVolume visible = facts.timed(progress, "threshold", [&] { return drop_invisible(volume, 0, function); });
    facts["dropped"] = visible.dropped;
    if (visible.volume.size() == 0) {
        throw Error(ErrorCode::InvalidInput, "leaves no point: nothing of the field can be seen", "--threshold");
    }
    facts["points"] = visible.volume.size();
    return {std::move(visible.volume), std::move(facts)};
}

RbfVolume reduce_reported(const HexMesh& mesh, const SampleArguments& arguments, const LimitOptions& limit, Facts& facts) {
    ReduceOptions options = arguments.reduction;
    options.kernel = arguments.sampling.kernel;
    options.limit = limit;
    options.progress = limit.progress;
    ReduceResult reduced = facts.timed(limit.progress, "reduce", [&] { return reduce_rbf(mesh, {}, options); });
    facts["points_before"] = mesh.points.size();
    facts["field_rmse"] = reduced.report.validation.rmse;
    if (reduced.report.points > mesh.points.size()) {
        facts.warn("these are more kernels than control points; --per-edge 1 has fewer, perhaps with no larger error");
    }
    if (!reduced.report.reached) {
        facts.warn(text("the field's error is ", reduced.report.validation.rmse, ", not ", arguments.reduction.rmse,
                        ": the samples of the volume are too far apart for more kernels"));
    }
    return std::move(reduced.volume);
}

RbfVolume sample_and_warn(HexMesh mesh, const SampleOptions& options, Facts& facts) {
    SampleResult sampled = facts.timed(options.progress, "sample", [&] { return sample_rbf_points(std::move(mesh), options); });
    if (options.tolerance > 0) {
        facts["largest_error"] = sampled.report.largest_error;
        if (sampled.report.largest_error > options.tolerance)
            facts.warn("the tolerance was not reached with 64 samples per cell edge");
    }
    if (sampled.report.flat_frames > 0) {
        facts.warn(text(sampled.report.flat_frames, " points lie where cells are flat; their kernels were thickened"));
    }
    return std::move(sampled.volume);
}

}  // namespace

WithFacts<RbfVolume> sample_reported(HexMesh mesh, const SampleArguments& arguments, const RefineArguments& refinement,
                                     const std::optional<TransferFunction>& seen, Progress* progress) {
    Facts facts;
    const RefineOptions refine_options = refinement.options(0, progress);
    SampleOptions options = arguments.options(bounds(mesh), refine_options);
    if (refinement.levels) {  // the refined mesh with its trilinear cells takes the place of the limit
        mesh = facts.unpack(refine_reported(mesh, refine_options, Vertices::OnTheLimit));
        options.scheme.kind = Scheme::Linear;
        options.boundary_levels = 0;
    }
    RbfVolume all;
    if (arguments.reduction.rmse > 0) {
        const LimitOptions limit{
            .scheme = options.scheme, .tolerance = ReduceOptions{}.limit.tolerance, .progress = options.progress};
        all = reduce_reported(mesh, arguments, limit, facts);
    } else {
        all = sample_and_warn(std::move(mesh), options, facts);
    }
    return without_invisible(std::move(all), arguments, seen, progress, std::move(facts));
}

void refuse_other_places(const SampleArguments& arguments, const SampleOptions& options) {
    const bool placed = options.per_edge != 1 || options.centers || options.spacing_world > 0 || options.footprint ||
                        options.tolerance > 0 || arguments.reduction.rmse > 0 || options.values != ValueRule::Scheme;
    if (placed) {
        throw Error(ErrorCode::InvalidInput, "the schemes of tetrahedra have one kernel at each point of a level", "--scheme",
                    "--levels makes more of them");
    }
}

WithFacts<RbfVolume> sample_tets_reported(const HexMesh& mesh, const SampleArguments& arguments,
                                          const std::optional<TransferFunction>& seen, Progress* progress) {
    Facts facts;
    const SampleOptions options = arguments.options(bounds(mesh), {});
    refuse_other_places(arguments, options);
    SampleResult sampled = facts.timed(progress, "sample", [&] {
        return sample_rbf_points(join_split_cells(mesh),
                                 {.correction = options.correction, .kernel = options.kernel, .progress = progress});
    });
    if (sampled.report.flat_frames > 0) {
        facts.warn(text(sampled.report.flat_frames, " points lie where cells are flat; their kernels were thickened"));
    }
    return without_invisible(std::move(sampled.volume), arguments, seen, progress, std::move(facts));
}

WithFacts<RbfVolume> sample_reported(const VdbGrid& grid, const SampleArguments& arguments,
                                     const std::optional<TransferFunction>& seen, const CLI::App& app, Progress* progress) {
    Facts facts;
    refuse_mesh_options(app, "needs a mesh; this is a grid of voxels");
    refuse_options(app, kOfMeshesOnly, "needs a mesh; this is a grid of voxels");
    const SampleOptions options = arguments.options(box_of(grid.report()), {});
    VoxelSampleResult sampled = facts.timed(progress, "sample", [&] {
        return vdb().sample_rbf_points(grid, {.spacing_world = options.spacing_world,
                                        .correction = options.correction,
                                        .kernel = options.kernel,
                                        .progress = progress});
    });
    facts["spacing"] = sampled.report.spacing_world;
    facts["voxels_a_side"] = sampled.report.voxels_a_side;
    if (sampled.report.left_out > 0) facts["left_out_voxels"] = sampled.report.left_out;
    return without_invisible(std::move(sampled.volume), arguments, seen, progress, std::move(facts));
}

}  // namespace subvol::cli
