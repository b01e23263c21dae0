// SPDX-License-Identifier: Apache-2.0
#include "sample_arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "choices.h"
#include "numbers.h"
#include "picture_arguments.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kPaperBox = 200;  // --spacing-voxels counts in 1/200 of the longest side

}  // namespace

Kernel kernel_from(const std::string& text, const char* fallback) {
    if (text.empty()) return named_kernel(fallback);
    return text.front() == '{' ? kernel_from_json(text) : named_kernel(text);
}

void SampleArguments::add_to(CLI::App& app) {
    auto* edges = app.add_option("--per-edge", per_edge, "sample intervals per cell edge; 1 is one kernel per control point");
    edges->type_name("N")->transform(whole_number(1, 64));
    auto* world = app.add_option("--spacing", spacing_world,
                                 "distance between samples in world units, instead of --per-edge; for a grid, "
                                 "rounded to whole voxels (default: one kernel per voxel)");
    world->type_name("H")->transform(positive_number())->excludes(edges);
    app.add_option("--spacing-voxels", spacing_voxels, "the same in units of 1/200 of the longest side of the bounding box")
        ->type_name("S")
        ->transform(positive_number())
        ->excludes(edges)
        ->excludes(world);
    app.add_option("--tolerance", tolerance,
                   "instead: as many samples as an error of the field below E needs, in the field's unit")
        ->type_name("E")
        ->transform(positive_number())
        ->excludes(edges)
        ->excludes(world);
    app.add_flag("--centers", centers,
                 "also a kernel in the middle of each small cell between the samples: twice as many kernels, about a third "
                 "of the error");
    app.add_option("--footprint", footprint,
                   "instead: samples at most 1.5 pixels apart as this camera sees them (numbers, a JSON file, or a side)")
        ->type_name("CAMERA")
        ->excludes(edges)
        ->excludes(world);
    app.add_option("--footprint-size", footprint_size, "the size of that camera's picture (default 512x512)")->type_name("WxH");
    app.add_option("--values", values,
                   "values between control points: scheme (exact, default), cubic (Catmull-Rom), paper (weighted mean)")
        ->type_name("NAME")
        ->check(offered(names_of<ValueRule>()));
    app.add_option("--kernel", kernel, "the kernel of the points (default compact); see subvol fit --kernels")
        ->type_name("NAME|JSON");
    app.add_option("--value-kernel", value_kernel, "the kernel of --values paper (default paper_bc)")->type_name("NAME|JSON");
    threshold_option_ = app.add_option("--threshold", threshold,
                                       "drop points that cannot be seen: where the field is at most V; without V, where the "
                                       "transfer function is transparent")
                            ->type_name("[V]")
                            ->expected(0, 1);
    app.add_option("--correction", correction,
                   "the derivatives of the field that kernels carry: none, gradient, second (default), full")
        ->type_name("NAME")
        ->check(offered(names_of<Correction>()));
    auto* reduce = app.add_option("--reduce", reduce_rmse,
                                  "instead: as few kernels as a root mean square error of RMSE needs, in the field's unit");
    reduce->type_name("RMSE")
        ->transform(positive_number())
        ->excludes(edges)
        ->excludes(world)
        ->excludes("--spacing-voxels")
        ->excludes("--tolerance")
        ->excludes("--footprint")
        ->excludes("--centers");
    app.add_flag("--refine", move_kernels,
                 "with --reduce: also move and resize the kernels: about half as many, ten times as slow")
        ->needs(reduce);
}

SampleOptions SampleArguments::options(const Box& box, const RefineOptions& refinement) const {
    const Vec3 size = box.size();
    const double voxel = std::max({size.x, size.y, size.z}) / kPaperBox;
    return {.scheme = refinement.scheme,
            .per_edge = per_edge,
            .spacing_world = spacing_voxels > 0 ? spacing_voxels * voxel : spacing_world,
            .footprint = footprint.empty() ? std::nullopt : std::optional(footprint_of(box)),
            .tolerance = tolerance,
            .centers = centers,
            .correction = named<Correction>(correction, "--correction"),
            .values = named<ValueRule>(values, "--values"),
            .kernel = kernel_from(kernel, "compact"),
            .value_kernel = kernel_from(value_kernel, "paper_bc"),
            .progress = refinement.progress};
}

bool SampleArguments::drops_invisible() const {
    return threshold_option_ != nullptr && threshold_option_->count() > 0;
}

Footprint SampleArguments::footprint_of(const Box& box) const {
    const PictureSize size = parse_size("--footprint-size", footprint_size);
    const double aspect = static_cast<double>(size.width) / size.height;
    return {
        .camera = camera_of_option("--footprint", footprint, box, aspect), .width_px = size.width, .height_px = size.height};
}

}  // namespace subvol::cli
