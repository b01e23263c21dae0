// SPDX-License-Identifier: Apache-2.0
#include "sample_arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "numbers.h"
#include "options.h"
#include "picture_arguments.h"
#include "subvol/option.h"
#include "subvol/visible_points.h"

namespace subvol::cli {

double world_of_voxels(double voxels, const Box& box) {
    constexpr double kPaperBox = 200;
    const Vec3 size = box.size();
    return voxels * (std::max({size.x, size.y, size.z}) / kPaperBox);
}

std::vector<Option> SampleArguments::described() {
    std::vector<Option> all = options_of(sampling);
    // The levels of the boundary follow from the samples here.
    std::erase_if(all, [](const Option& option) { return option.name == "boundary-levels"; });
    all.push_back(Option("spacing-voxels", spacing_voxels)
                      .positive()
                      .or_none()
                      .help("S", "the same as --spacing in units of 1/200 of the longest side of the bounding box")
                      .instead_of({"per-edge", "spacing"}));
    all.push_back(Option("footprint", footprint)
                      .help("CAMERA",
                            "instead: samples at most 1.5 pixels apart as this camera sees them (numbers, a JSON file, or a "
                            "side)")
                      .instead_of({"per-edge", "spacing"}));
    all.push_back(
        Option("footprint-size", footprint_size).help("WxH", "the size of that camera's picture").only_with("footprint"));
    all.push_back(Option("reduce", reduction.rmse)
                      .positive()
                      .help("RMSE", "instead: as few kernels as a root mean square error of RMSE needs, in the field's unit")
                      .instead_of({"per-edge", "spacing", "spacing-voxels", "tolerance", "footprint", "centers", "values",
                                   "correction"}));
    all.push_back(Option("refine", reduction.move)
                      .help("with --reduce: also move and resize the kernels: about half as many, ten times as slow")
                      .only_with("reduce"));
    return all;
}

void SampleArguments::add_to(CLI::App& app) {
    add_options(app, described());
    threshold_option_ = app.add_option("--threshold", threshold,
                                       "drop points that cannot be seen: where the field is at most V; without V, where the "
                                       "transfer function is transparent")
                            ->type_name("[V]")
                            ->expected(0, 1);
}

SampleOptions SampleArguments::options(const Box& box, const RefineOptions& refinement) const {
    SampleOptions options = sampling;
    options.scheme = refinement.scheme;
    options.progress = refinement.progress;
    if (spacing_voxels > 0) options.spacing_world = world_of_voxels(spacing_voxels, box);
    if (!footprint.empty()) options.footprint = footprint_of(box);
    return options;
}

KernelOptions SampleArguments::kernel_options(const Box& box, const RefineOptions& refinement,
                                              std::optional<int> levels) const {
    KernelOptions kernels{.sample = options(box, refinement),
                          .levels = levels,
                          .reduce_rmse = reduction.rmse,
                          .move = reduction.move,
                          .levels_option = "--levels",
                          .progress = refinement.progress};
    if (!threshold.empty()) kernels.visible = opaque_above(parse_number("--threshold", threshold));
    return kernels;
}

bool SampleArguments::drops_invisible() const {
    return threshold_option_ != nullptr && threshold_option_->count() > 0 && threshold.empty();
}

Footprint SampleArguments::footprint_of(const Box& box) const {
    const PictureSize size = parse_size(footprint_size, "--footprint-size");
    const double aspect = static_cast<double>(size.width) / size.height;
    return {
        .camera = camera_of_option("--footprint", footprint, box, aspect), .width_px = size.width, .height_px = size.height};
}

}  // namespace subvol::cli
