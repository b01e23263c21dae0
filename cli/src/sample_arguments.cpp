#include "sample_arguments.h"

#include <algorithm>

#include "grid_input.h"
#include "picture_arguments.h"
#include "subvol/empty_space.h"
#include "subvol/error.h"
#include "subvol/reduce.h"
#include "subvol/vdb_sample.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr std::initializer_list<const char*> kOfMeshesOnly{
    "--density",      "--other-cells", "--per-edge",  "--scheme",         "--tension", "--levels",
    "--crease-angle", "--tolerance",   "--footprint", "--footprint-size", "--values",  "--value-kernel",
    "--reduce",       "--refine",      "--seconds",   "--color-field"};
constexpr double kPaperBox = 200;  // --spacing-voxels counts in 1/200 of the longest side

Correction correction_named(const std::string& name) {
    check_choice("--correction", name, {"none", "gradient", "second", "full"});
    if (name == "full") return Correction::Full;
    return name == "none" ? Correction::None : name == "gradient" ? Correction::Gradient : Correction::Second;
}

ValueRule rule_named(const std::string& name) {
    check_choice("--values", name, {"scheme", "cubic", "paper"});
    return name == "paper" ? ValueRule::Paper : name == "cubic" ? ValueRule::Cubic : ValueRule::Scheme;
}

Kernel kernel_from(const std::string& text, const char* fallback) {
    if (text.empty()) return named_kernel(fallback);
    return text.front() == '{' ? kernel_from_json(text) : named_kernel(text);
}

}  // namespace

void SampleArguments::add_to(CLI::App& app) {
    auto* edges = app.add_option("--per-edge", per_edge, "sample intervals per cell edge; 1 is one kernel a control point");
    edges->type_name("N")->check(CLI::Range(1, 64));
    auto* world = app.add_option("--spacing", spacing_world,
                                 "distance of the samples, in world units, instead of --per-edge; of a grid's "
                                 "kernels, to whole voxels (default: a kernel a voxel)");
    world->type_name("H")->check(CLI::PositiveNumber)->excludes(edges);
    app.add_option("--spacing-voxels", spacing_voxels, "the same in 1/200 of the longest side of the bounding box")
        ->type_name("S")
        ->check(CLI::PositiveNumber)
        ->excludes(edges)
        ->excludes(world);
    app.add_option("--tolerance", tolerance,
                   "instead: as many samples as it takes until the field errs by less, in its own unit")
        ->type_name("E")
        ->check(CLI::PositiveNumber)
        ->excludes(edges)
        ->excludes(world);
    app.add_option("--footprint", footprint,
                   "instead: samples at most 1.5 pixels apart as this camera sees them (numbers, a JSON file, or a side)")
        ->type_name("CAMERA")
        ->excludes(edges)
        ->excludes(world);
    app.add_option("--footprint-size", footprint_size, "the size of that camera's picture (default 512x512)")->type_name("WxH");
    app.add_option("--values", values,
                   "values between control points: scheme (exact, default), cubic (Catmull-Rom), paper (weighted mean)")
        ->type_name("NAME");
    app.add_option("--kernel", kernel, "the kernel of the points (default compact); see subvol fit --kernels")
        ->type_name("NAME|JSON");
    app.add_option("--value-kernel", value_kernel, "the kernel of --values paper (default paper_bc)")->type_name("NAME|JSON");
    threshold_option = app.add_option("--threshold", threshold,
                                      "drop points that cannot be seen: where the field is at most V; without V, where the "
                                      "transfer function is clear")
                           ->type_name("[V]")
                           ->expected(0, 1);
    app.add_option("--correction", correction, "how far a kernel follows the field: none, gradient, second (default), full")
        ->type_name("NAME");
    auto* reduce = app.add_option("--reduce", reduce_rmse,
                                  "instead: as few kernels as a root mean square error of RMSE, in units of the field, needs");
    reduce->type_name("RMSE")
        ->check(CLI::PositiveNumber)
        ->excludes(edges)
        ->excludes(world)
        ->excludes("--spacing-voxels")
        ->excludes("--tolerance")
        ->excludes("--footprint");
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
            .footprint = footprint.empty() ? std::nullopt : std::optional(footprint_of(box)),
            .tolerance = tolerance,
            .correction = correction_named(correction),
            .values = rule_named(values),
            .kernel = kernel_from(kernel, "compact"),
            .value_kernel = kernel_from(value_kernel, "paper_bc"),
            .crease_angle_deg = refinement.crease_angle_deg,
            .progress = refinement.progress};
}

Footprint SampleArguments::footprint_of(const Box& box) const {
    const PictureSize size = parse_size("--footprint-size", footprint_size);
    const double aspect = static_cast<double>(size.width) / size.height;
    return {.camera = parse_camera(footprint, box, aspect), .width_px = size.width, .height_px = size.height};
}

namespace {

RbfVolume without_invisible(RbfVolume volume, const SampleArguments& arguments, const std::optional<TransferFunction>& seen,
                            Report& report) {
    if (arguments.threshold_option->count() == 0) return volume;
    if (arguments.threshold.empty() && !seen) {
        throw Error(ErrorCode::InvalidInput, "needs a value, there is no transfer function", "--threshold");
    }
    const TransferFunction function =
        arguments.threshold.empty() ? *seen : above(parse_number("--threshold", arguments.threshold));
    VisibleVolume visible = report.timed("threshold", [&] { return drop_invisible(volume, 0, function); });
    report["dropped"] = visible.dropped;
    if (visible.volume.size() == 0) {
        throw Error(ErrorCode::InvalidInput, "leaves no point: nothing of the field can be seen", "--threshold");
    }
    return std::move(visible.volume);
}

RbfVolume reduce_reported(const HexMesh& mesh, const SampleArguments& arguments, const LimitOptions& limit, Report& report) {
    const ReduceOptions options{.rmse = arguments.reduce_rmse,
                                .kernel = kernel_from(arguments.kernel, "compact"),
                                .move = arguments.move_kernels,
                                .limit = limit,
                                .progress = limit.progress};
    ReduceResult reduced = report.timed("reduce", [&] { return reduce_rbf(mesh, options); });
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

RbfVolume sample_and_warn(HexMesh mesh, const SampleOptions& options, Report& report) {
    SampleResult sampled = report.timed("sample", [&] { return sample_rbf_points(std::move(mesh), options); });
    if (options.tolerance > 0) {
        report["largest_error"] = sampled.report.largest_error;
        if (sampled.report.largest_error > options.tolerance)
            report.warn("the tolerance was not reached with 64 samples a cell edge");
    }
    if (sampled.report.flat_frames > 0) {
        report.warn(text(sampled.report.flat_frames, " points lie where cells are flat; their kernels were thickened"));
    }
    return std::move(sampled.volume);
}

}  // namespace

RbfVolume sample_reported(HexMesh mesh, const SampleArguments& arguments, const RefineArguments& refinement,
                          const std::optional<TransferFunction>& seen, Report& report) {
    const RefineOptions refine_options = refinement.options(0, report);
    SampleOptions options = arguments.options(bounds(mesh), refine_options);
    if (refinement.levels) {  // the refined mesh with its trilinear cells takes the place of the limit
        mesh = refine_reported(mesh, refine_options, Vertices::OnTheLimit, report);
        options.scheme = Scheme::Linear;
        options.boundary_levels = 0;
    }
    RbfVolume all;
    if (arguments.reduce_rmse > 0) {
        const LimitOptions limit{.scheme = options.scheme,
                                 .tension = options.tension,
                                 .tolerance = ReduceOptions{}.limit.tolerance,
                                 .crease_angle_deg = options.crease_angle_deg,
                                 .progress = options.progress};
        all = reduce_reported(mesh, arguments, limit, report);
    } else {
        all = sample_and_warn(std::move(mesh), options, report);
    }
    RbfVolume volume = without_invisible(std::move(all), arguments, seen, report);
    report["points"] = volume.size();
    return volume;
}

RbfVolume sample_reported(const VdbGrid& grid, const SampleArguments& arguments, const std::optional<TransferFunction>& seen,
                          const CLI::App& app, Report& report) {
    refuse_options(app, kOfMeshesOnly, "needs a mesh; this is a grid of voxels");
    const SampleOptions options = arguments.options(box_of(grid.report()), {});
    VoxelSampleResult sampled = report.timed("sample", [&] {
        return sample_rbf_points(grid, {.spacing_world = options.spacing_world,
                                        .correction = options.correction,
                                        .kernel = options.kernel,
                                        .progress = report.progress()});
    });
    report["spacing"] = sampled.report.spacing_world;
    report["voxels_a_side"] = sampled.report.voxels_a_side;
    if (sampled.report.left_out > 0) report["left_out_voxels"] = sampled.report.left_out;
    RbfVolume volume = without_invisible(std::move(sampled.volume), arguments, seen, report);
    report["points"] = volume.size();
    return volume;
}

}  // namespace subvol::cli
