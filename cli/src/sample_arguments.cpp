#include "sample_arguments.h"

#include <algorithm>

#include "subvol/reduce.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kPaperBox = 200;  // --spacing-voxels counts in 1/200 of the longest side

Correction correction_named(const std::string& name) {
    check_choice("--correction", name, {"none", "gradient", "second"});
    return name == "none" ? Correction::None : name == "gradient" ? Correction::Gradient : Correction::Second;
}

}  // namespace

void SampleArguments::add_to(CLI::App& app) {
    auto* edges = app.add_option("--per-edge", per_edge, "sample intervals per cell edge; 1 is one kernel a control point");
    edges->type_name("N")->check(CLI::Range(1, 64));
    auto* world = app.add_option("--spacing", spacing_world, "distance of the samples, in world units, instead of --per-edge");
    world->type_name("H")->check(CLI::PositiveNumber)->excludes(edges);
    app.add_option("--spacing-voxels", spacing_voxels, "the same in 1/200 of the longest side of the bounding box")
        ->type_name("S")
        ->check(CLI::PositiveNumber)
        ->excludes(edges)
        ->excludes(world);
    app.add_option("--correction", correction, "how far a kernel follows the field: none, gradient, second (default)")
        ->type_name("NAME");
    auto* reduce = app.add_option("--reduce", reduce_rmse,
                                  "instead: as few kernels as a root mean square error of RMSE, in units of the field, needs");
    reduce->type_name("RMSE")->check(CLI::PositiveNumber)->excludes(edges)->excludes(world);
    app.add_flag("--refine", move_kernels,
                 "with --reduce: move and resize the kernels too: about half as many, ten times as slow")
        ->needs(reduce);
}

SampleOptions SampleArguments::options(const Box& box, const RefineOptions& refinement) const {
    const Vec3 size = box.size();
    const double voxel = std::max({size.x, size.y, size.z}) / kPaperBox;
    return {.scheme = refinement.scheme,
            .tension = refinement.tension,
            .per_edge = per_edge,
            .spacing_world = spacing_voxels > 0 ? spacing_voxels * voxel : spacing_world,
            .correction = correction_named(correction),
            .crease_angle_deg = refinement.crease_angle_deg,
            .progress = refinement.progress};
}

namespace {

RbfVolume reduce_reported(const HexMesh& mesh, const SampleArguments& arguments, const LimitOptions& limit, Report& report) {
    const ReduceOptions options{
        .rmse = arguments.reduce_rmse, .move = arguments.move_kernels, .limit = limit, .progress = limit.progress};
    ReduceResult reduced = report.timed("reduce", [&] { return reduce_rbf(mesh, options); });
    report["points"] = reduced.report.points;
    report["points_before"] = mesh.points.size();
    report["field_rmse"] = reduced.report.validation.rmse;
    if (reduced.report.points > mesh.points.size()) {
        report.warn("these are more kernels than control points: --per-edge 1 has fewer, maybe at no greater error");
    }
    if (!reduced.report.reached) {
        report.warn(text("the field's error is ", reduced.report.validation.rmse, ", not ", arguments.reduce_rmse,
                         ": the samples of the volume are too far apart for more kernels"));
    }
    return std::move(reduced.volume);
}

}  // namespace

RbfVolume sample_reported(const HexMesh& mesh, const SampleArguments& arguments, const RefineArguments& refinement,
                          Report& report) {
    const RefineOptions refine_options = refinement.options(0, report);
    SampleOptions options = arguments.options(bounds(mesh), refine_options);
    HexMesh level;
    if (refinement.levels) {  // the refined mesh with its trilinear cells takes the place of the limit
        level = refine_reported(mesh, refine_options, Vertices::OnTheLimit, report);
        options.scheme = Scheme::Linear;
        options.boundary_levels = 0;
    }
    if (arguments.reduce_rmse > 0) {
        return reduce_reported(refinement.levels ? level : mesh, arguments,
                               {.scheme = options.scheme,
                                .tension = options.tension,
                                .tolerance = ReduceOptions{}.limit.tolerance,
                                .crease_angle_deg = options.crease_angle_deg,
                                .progress = options.progress},
                               report);
    }
    SampleResult sampled = report.timed("sample", [&] { return sample_rbf_points(refinement.levels ? level : mesh, options); });
    report["points"] = sampled.volume.size();
    if (sampled.report.flat_frames > 0) {
        report.warn(text(sampled.report.flat_frames, " points lie where cells are flat; their kernels were thickened"));
    }
    return std::move(sampled.volume);
}

}  // namespace subvol::cli
